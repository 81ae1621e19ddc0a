"""What all commands share: the terminal, output for people and scripts, result files."""
