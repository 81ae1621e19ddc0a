"""Ants: the planners that search a lattice by ant colony optimisation."""

from ffsr_plan.colony.ant_system import AntSystem
from ffsr_plan.colony.max_min import MaxMinAntSystem
from ffsr_plan.colony.records import Cycle, History, Planner, Search, Trails, Watch

__all__ = [
    "AntSystem",
    "Cycle",
    "History",
    "MaxMinAntSystem",
    "Planner",
    "Search",
    "Trails",
    "Watch",
]
