"""Random satellites as plain records, written as URDF and SRDF for the package and as MJCF.

Both texts are written from the same record, so that a reader of one of them cannot spoil the other.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

KINDS = ("revolute", "continuous", "prismatic", "fixed")
SOLIDS = ("box", "sphere", "capsule", "mesh")
LIMIT = {"revolute": 2.5, "prismatic": 0.5}  # [rad] and [m], to either side


class Solid(NamedTuple):
    """A convex collision shape on a link.

    Attributes:
        kind: `box`, `sphere`, `capsule`, `cylinder` or `mesh`.
        sizes: half sides, (radius,), (radius, half length), or (n, 3) corners of a hull [m].
        xyz: (3,) origin in the link's frame [m].
        rpy: (3,) rotations about the fixed axes x, y, z [rad].
    """

    kind: str
    sizes: np.ndarray
    xyz: np.ndarray
    rpy: np.ndarray


class Body(NamedTuple):
    """A link and the joint that carries it.

    Attributes:
        name: of the link; its joint is `joint_` and the name.
        parent: number of the parent link; -1 for the base.
        kind: kind of the joint.
        axis: (3,) unit vector of the joint.
        xyz: (3,) origin of the joint in the parent's frame [m].
        rpy: (3,) rotation of the joint's frame [rad].
        mass: [kg].
        center: (3,) centre of mass [m].
        moments: (3,) principal moments [kg m^2].
        principal: (3,) rotation of the principal axes [rad].
        solids: collision shapes.
    """

    name: str
    parent: int
    kind: str
    axis: np.ndarray
    xyz: np.ndarray
    rpy: np.ndarray
    mass: float
    center: np.ndarray
    moments: np.ndarray
    principal: np.ndarray
    solids: tuple[Solid, ...]


class Satellite(NamedTuple):
    """A tree of bodies, the base first.

    Attributes:
        bodies: the links, each after its parent.
        exempt: pairs of link names that an SRDF lets touch.
    """

    bodies: tuple[Body, ...]
    exempt: tuple[tuple[str, str], ...]

    @property
    def moving(self):
        """The bodies whose joints move."""
        return [body for body in self.bodies if body.kind not in ("base", "fixed")]

    def checked_pairs(self):
        """Pairs of numbers of links that must not touch.

        Links on one rigid body may touch. So may links with exactly one moving joint between them,
        if no link between them has a shape, and pairs of the SRDF.
        """
        pairs = []
        for a, first in enumerate(self.bodies):
            for b, second in enumerate(self.bodies[:a]):
                moving, between = self._between(a, b)
                shaped = any(self.bodies[k].solids for k in between)
                touching = moving == 0 or (moving == 1 and not shaped)
                if not touching and tuple(sorted((first.name, second.name))) not in self.exempt:
                    pairs.append((b, a))
        return pairs

    def _between(self, a, b):
        """Number of moving joints between two links, and the links between them."""
        above = [self._ancestors(a), self._ancestors(b)]
        common = next(k for k in above[0] if k in above[1])
        ways = [chain[: chain.index(common)] for chain in above]
        moving = sum(self.bodies[k].kind != "fixed" for way in ways for k in way)
        return moving, ({*ways[0], *ways[1], common} - {a, b})

    def _ancestors(self, k):
        chain = [k]
        while self.bodies[chain[-1]].parent >= 0:
            chain.append(self.bodies[chain[-1]].parent)
        return chain


def random_satellite(rng, solids=SOLIDS, arms=2, depth=3):
    """A base with arms of all kinds of joints and shapes; masses differ by orders of magnitude."""
    scale = 10.0 ** rng.uniform(-0.5, 1.5)
    bodies = [_body(rng, "base", -1, "base", float(2.0 * scale), 0.3 * scale**0.33, ("box",))]
    for arm in range(arms):
        parent = 0
        for k in range(int(rng.integers(1, depth + 1))):
            kind = str(rng.choice(KINDS[:3] if k == 0 else KINDS))
            mass = float(10.0 ** rng.uniform(-1.0, 0.5))
            bodies.append(_body(rng, f"arm{arm}_{k}", parent, kind, mass, 0.09, solids))
            parent = len(bodies) - 1
    names = [body.name for body in bodies]
    count = int(rng.integers(0, 3))
    pairs = {tuple(sorted(rng.choice(names, 2, replace=False).tolist())) for _ in range(count)}
    return Satellite(tuple(bodies), tuple(sorted(pairs)))


def write_files(satellite, folder):
    """Write URDF, SRDF and the meshes of a satellite; returns the paths of URDF and SRDF."""
    parts, folder = ["<robot name='random'>"], Path(folder)
    for body in satellite.bodies:
        shapes = []
        for number, solid in enumerate(body.solids):
            if solid.kind == "mesh":
                hull = trimesh.Trimesh(solid.sizes, ConvexHull(solid.sizes).simplices)
                hull.fix_normals()
                hull.export(folder / f"{body.name}_{number}.obj", digits=17)
            shapes.append(_urdf_shape(solid, f"{body.name}_{number}.obj"))
        ixx, iyy, izz = body.moments.tolist()
        parts.append(
            f"<link name='{body.name}'><inertial>{_origin(body.center, body.principal)}"
            f"<mass value='{body.mass!r}'/><inertia ixx='{ixx!r}' iyy='{iyy!r}' izz='{izz!r}' "
            f"ixy='0' ixz='0' iyz='0'/></inertial>{''.join(shapes)}</link>"
        )
        if body.parent >= 0:
            parts.append(_urdf_joint(satellite, body))
    urdf, srdf = folder / "random.urdf", folder / "random.srdf"
    urdf.write_text("".join([*parts, "</robot>"]))
    pairs = [f"<disable_collisions link1='{a}' link2='{b}'/>" for a, b in satellite.exempt]
    srdf.write_text(f"<robot name='random'>{''.join(pairs)}</robot>")
    return urdf, srdf


def mjcf(satellite, radii):
    """The satellite among so many movable spheres as MuJoCo's own XML, without gravity."""
    meshes, children = [], {k: [] for k in range(-1, len(satellite.bodies))}
    for k, body in enumerate(satellite.bodies):
        children[body.parent].append(k)
        meshes += [
            f"<mesh name='{body.name}_{n}' vertex='{_text(solid.sizes.ravel())}'/>"
            for n, solid in enumerate(body.solids)
            if solid.kind == "mesh"
        ]

    def element(k):
        body = satellite.bodies[k]
        joint = "<freejoint/>" if body.parent < 0 else ""
        if body.kind in ("revolute", "continuous", "prismatic"):
            kind = "slide" if body.kind == "prismatic" else "hinge"
            joint = f"<joint name='joint_{body.name}' type='{kind}' axis='{_text(body.axis)}'/>"
        geoms = [_geom(solid, f"{body.name}_{n}") for n, solid in enumerate(body.solids)]
        return (
            f"<body name='{body.name}' {_pose(body.xyz, body.rpy)}>{joint}<inertial mass="
            f"'{float(body.mass)!r}' {_pose(body.center, body.principal)} diaginertia="
            f"'{_text(body.moments)}'/>{''.join(geoms)}{''.join(map(element, children[k]))}</body>"
        )

    spheres = [
        f"<body mocap='true'><geom name='obstacle_{n}' type='sphere' "
        f"size='{float(radius)!r}'/></body>"
        for n, radius in enumerate(radii)
    ]
    return (
        "<mujoco><compiler balanceinertia='false' boundmass='0' boundinertia='0' autolimits="
        "'false' fusestatic='false'/><option gravity='0 0 0' ccd_tolerance='1e-10' "
        f"ccd_iterations='200'/><asset>{''.join(meshes)}</asset><worldbody>{element(0)}"
        f"{''.join(spheres)}</worldbody></mujoco>"
    )


def _body(rng, name, parent, kind, mass, size, solids):
    axis = rng.normal(size=3) if rng.random() < 0.6 else np.eye(3)[rng.integers(3)]
    far = 0.0 if parent < 0 else 0.25
    second = rng.uniform(0.05, 1.0, 3) * mass * size**2
    x, y, z = second
    shapes = [_solid(rng, str(rng.choice(solids)), size) for _ in range(int(rng.integers(1, 3)))]
    return Body(
        name,
        parent,
        kind,
        axis / np.linalg.norm(axis),
        np.zeros(3)
        if parent < 0
        else rng.uniform(-far, far, 3) + np.sign(rng.normal(size=3)) * 0.25,
        np.zeros(3) if parent < 0 else rng.uniform(-3.0, 3.0, 3),
        mass,
        rng.uniform(-size, size, 3),
        np.array([y + z, x + z, x + y]),
        rng.uniform(-3.0, 3.0, 3),
        tuple(shapes) if parent < 0 or rng.random() < 0.9 else (),
    )


def _solid(rng, kind, size):
    xyz, rpy = rng.uniform(-size, size, 3), rng.uniform(-3.0, 3.0, 3)
    if kind == "mesh":
        return Solid(kind, rng.uniform(-size, size, (12, 3)), xyz, rpy)
    count = {"box": 3, "sphere": 1, "capsule": 2, "cylinder": 2}[kind]
    return Solid(kind, rng.uniform(0.2 * size, size, count), xyz, rpy)


def _urdf_shape(solid, address):
    s = [float(v) for v in np.ravel(solid.sizes)]
    element = {
        "box": lambda: f"<box size='{_text(2.0 * solid.sizes)}'/>",
        "sphere": lambda: f"<sphere radius='{s[0]!r}'/>",
        "capsule": lambda: f"<capsule radius='{s[0]!r}' length='{2.0 * s[1]!r}'/>",
        "cylinder": lambda: f"<cylinder radius='{s[0]!r}' length='{2.0 * s[1]!r}'/>",
        "mesh": lambda: f"<mesh filename='{address}'/>",
    }[solid.kind]()
    origin = _origin(solid.xyz, solid.rpy)
    return f"<collision>{origin}<geometry>{element}</geometry></collision>"


def _urdf_joint(satellite, body):
    limit = LIMIT.get(body.kind)
    bounds = "" if limit is None else f"lower='{-limit}' upper='{limit}' "
    moves = body.kind != "fixed"
    extra = f"<axis xyz='{_text(body.axis)}'/><limit {bounds}effort='1' velocity='1'/>"
    return (
        f"<joint name='joint_{body.name}' type='{body.kind}'>"
        f"<parent link='{satellite.bodies[body.parent].name}'/><child link='{body.name}'/>"
        f"{_origin(body.xyz, body.rpy)}{extra if moves else ''}</joint>"
    )


def _geom(solid, name):
    size = "" if solid.kind == "mesh" else f"size='{_text(solid.sizes)}'"
    mesh = f"mesh='{name}'" if solid.kind == "mesh" else ""
    pose = _pose(solid.xyz, solid.rpy)
    return f"<geom name='{name}' type='{solid.kind}' {size} {mesh} {pose}/>"


def _pose(xyz, rpy):
    x, y, z, w = Rotation.from_euler("xyz", rpy).as_quat()
    return f"pos='{_text(xyz)}' quat='{_text((w, x, y, z))}'"


def _origin(xyz, rpy):
    return f"<origin xyz='{_text(xyz)}' rpy='{_text(rpy)}'/>"


def _text(numbers):
    return " ".join(repr(float(n)) for n in numbers)
