"""Ants: the planners that search a lattice by ant colony optimisation."""

from ffsr_plan.colony.ant_system import AntSystem
from ffsr_plan.colony.records import Cycle, History, Search, Trails

__all__ = ["AntSystem", "Cycle", "History", "Search", "Trails"]
