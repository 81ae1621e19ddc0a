"""URDFs of example-robot-data: each loads and agrees with yourdfpy, or is refused for its fault."""

import warnings
from importlib.metadata import distribution
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import yourdfpy

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.urdf.canonical import read_urdf, urdf_text
from ffsr_plan.robots.urdf.origins import transform
from tests.helpers.sample_sizes import sample

SHARE = Path(str(distribution("example-robot-data").locate_file("cmeel.prefix/share")))
ROBOTS = SHARE / "example-robot-data" / "robots"
NO_BODY = "no two sum to less than the third"
VISUAL = "<visual> without <collision>"
MIMIC = ", mimic"
EMPTY = "lower less than upper"
MASSLESS = "a mass of the moving link"
REFUSED = {
    "alex_psyonic_hands": (NO_BODY, MIMIC),
    "allegro_left_hand": (NO_BODY,),
    "allegro_right_hand": (NO_BODY,),
    "anymal": (NO_BODY,),  # of ANYmal B all moments are 1e-6; of C a camera's tensor
    "anymal-kinova": (NO_BODY,),
    "b1": (NO_BODY, VISUAL),
    "b1-z1": (NO_BODY, VISUAL),
    "go1": (NO_BODY, VISUAL),
    "hyq_no_sensors": (NO_BODY,),
    "pr2": (NO_BODY, VISUAL, MIMIC),
    "romeo_laas_small": (NO_BODY, VISUAL, MASSLESS),
    "romeo_small": (NO_BODY, VISUAL),
    "tiago": (NO_BODY, VISUAL),
    "tiago_dual": (NO_BODY, VISUAL),
    "tiago_no_hand": (NO_BODY, VISUAL),
    "a1": (VISUAL,),
    "alexander_v1.lowerBodyOnly": (VISUAL,),
    "TwoDofs": (VISUAL,),
    "baxter": (VISUAL, MIMIC),
    "g1_29dof_rev_1_0": (VISUAL,),
    "g1_29dof_with_hand_rev_1_0": (VISUAL,),
    "go2": (VISUAL,),
    "human": (VISUAL, MASSLESS),
    "so100": (VISUAL,),
    "talos_full_v2": (VISUAL, MIMIC),
    "talos_full_v2_box": (VISUAL, MIMIC),
    "talos_reduced": (VISUAL,),
    "talos_reduced_box": (VISUAL,),
    "talos_reduced_corrected": (VISUAL,),
    "tiago_pro": (VISUAL, MIMIC),
    "z1": (VISUAL,),
    "panda": (MIMIC,),
    "panda_collision": (MIMIC,),
    "romeo": (MIMIC,),
    "centauro": (EMPTY,),
    "double_pendulum": (EMPTY,),
    "double_pendulum_simple": (EMPTY,),
    "quadruped": (EMPTY,),
    "bolt": ("greater than 0 kg",),  # inertia without mass
    "ur3": ("robot name: got None",),  # a launch file under the name of a robot
}
"""What is wrong with a file: by default, and with `collision="ignore"`, `inertia="balance"`."""


def files():
    found = sorted(ROBOTS.rglob("*.urdf"))
    assert len(found) >= 60
    return found


def refusal(text, name, **options):
    """The message of a refusal, without reading meshes; None if the file is taken."""
    try:
        robot_from_urdf(without_meshes(read_urdf(text, name, **options)), name, collision="ignore")
    except fp.InvalidInput as error:
        return str(error)
    return None


def without_meshes(root):
    """The text, small balls in place of meshes."""
    for geometry in root.iter("geometry"):
        if geometry[0].tag == "mesh":
            geometry[:] = [ElementTree.Element("sphere", radius="0.05")]
    return urdf_text(root)


@pytest.mark.parametrize("path", files(), ids=lambda path: path.stem)
def test_a_public_file_is_taken_or_refused_for_a_reason_that_holds(path, capfd):
    text, faults = path.read_text(encoding="utf-8-sig"), REFUSED.get(path.stem, ())
    said = refusal(text, path.stem)
    assert (said is None) == (not faults), said
    if said is not None:
        assert said.startswith(path.stem)
        assert any(fault in said for fault in faults), said
    lasting = [fault for fault in faults if fault not in (NO_BODY, VISUAL)]
    said = refusal(text, path.stem, collision="ignore", inertia="balance")
    assert (said is None) == (not lasting), said
    assert said is None or any(fault in said for fault in lasting), said
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("path", files()[::3], ids=lambda path: path.stem)
def test_masses_and_placements_of_public_files_are_those_of_yourdfpy(path):
    text = path.read_text(encoding="utf-8-sig")
    if [fault for fault in REFUSED.get(path.stem, ()) if fault not in (NO_BODY, VISUAL, MIMIC)]:
        return
    root = read_urdf(text, path.stem, collision="ignore", inertia="balance")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        own = yourdfpy.URDF.load(str(path), build_scene_graph=False, load_meshes=False).robot
    joints = {joint.name: joint for joint in own.joints}
    for joint in root.findall("joint"):
        rotation, position = transform(joint)
        given = joints[joint.get("name")].origin
        given = np.eye(4) if given is None else given
        assert np.allclose(given[:3, 3], position)
        assert np.allclose(given[:3, :3], rotation)
    for link in own.links:
        (element,) = root.iterfind(f"link[@name='{link.name}']")
        mass = element.find("inertial/mass")
        assert (mass is None) == (link.inertial is None)
        if mass is not None:
            assert float(mass.get("value")) == link.inertial.mass


@pytest.mark.slow
@pytest.mark.parametrize("path", files()[:: sample(3, 1)], ids=lambda path: path.stem)
def test_public_files_load_with_their_meshes(path):
    faults = REFUSED.get(path.stem, ())
    if any(fault not in (NO_BODY, VISUAL) for fault in faults):
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fp.UncheckedLinks)
        options = {"collision": "ignore", "inertia": "balance"}
        robot = fp.load_robot(path, [SHARE], **options)
    assert robot.mass > 0.0
