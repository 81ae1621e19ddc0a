"""Ants: the planners that search a lattice by ant colony optimisation."""

from ffsr_plan.colony.ant_system import AntSystem
from ffsr_plan.colony.max_min import MaxMinAntSystem
from ffsr_plan.colony.records import Cycle, History, Search, Trails, Watch

__all__ = ["AntSystem", "Cycle", "History", "MaxMinAntSystem", "Search", "Trails", "Watch"]
