"""`python -m ffsr_plan`: the command `ffsr-plan`."""

from ffsr_plan_command import main

main()
