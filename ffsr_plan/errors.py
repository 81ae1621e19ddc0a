"""All errors and warnings of the package, and the data that they hold."""

from ffsr_plan.core.errors import (
    AttitudeOutOfReach,
    FfsrPlanError,
    GoalInCollision,
    GoalPoseIgnored,
    IntegrationError,
    InternalError,
    InvalidInput,
    NoPath,
    OutOfTime,
    PathNotFound,
    PlanningError,
    PlanNotVerified,
    StartInCollision,
    UncheckedLinks,
    UnprovenPath,
    WorkerDied,
)
from ffsr_plan.goal_poses.pose_out_of_reach import (
    ArmReach,
    HeldBase,
    JointBeyond,
    PoseOutOfReach,
)

__all__ = [
    "ArmReach",
    "AttitudeOutOfReach",
    "FfsrPlanError",
    "GoalInCollision",
    "GoalPoseIgnored",
    "HeldBase",
    "IntegrationError",
    "InternalError",
    "InvalidInput",
    "JointBeyond",
    "NoPath",
    "OutOfTime",
    "PathNotFound",
    "PlanNotVerified",
    "PlanningError",
    "PoseOutOfReach",
    "StartInCollision",
    "UncheckedLinks",
    "UnprovenPath",
    "WorkerDied",
]
