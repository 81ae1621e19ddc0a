"""A second reader of URDF for tests: standard library and numpy, none of the package's code.

It follows the standard: direct children only, defaults where an element is missing. Numbers are
plain ASCII digits between XML's blanks; anything else is `None`, "no reader may take this".
"""

import re
from xml.etree import ElementTree

import numpy as np

NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?", re.ASCII)


def plain(text, default=None):
    text = default if text is None else text
    return np.array(
        [float(word) if NUMBER.fullmatch(word) else np.nan for word in re.split("[ \t\r\n]+", text)
         if word]
    )  # fmt: skip


def pose(element):
    """(4, 4) of the `<origin>` of an element, which may hold a quaternion."""
    result, origin = np.eye(4), element.find("origin")
    if origin is None:
        return result
    result[:3, 3] = plain(origin.get("xyz"), "0 0 0")
    if origin.get("quat_xyzw") is not None:
        q = plain(origin.get("quat_xyzw"))
        x, y, z, w = q / np.linalg.norm(q)
        skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        result[:3, :3] = np.eye(3) + 2 * w * skew + 2 * skew @ skew
        return result
    r, p, y = plain(origin.get("rpy"), "0 0 0")
    for unit, angle in (((1, 0, 0), r), ((0, 1, 0), p), ((0, 0, 1), y)):
        result[:3, :3] = about(np.array(unit), angle) @ result[:3, :3]
    return result


def about(axis, angle):
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


class ByHand:
    """Links and joints of a URDF text."""

    def __init__(self, text):
        root = ElementTree.fromstring(text)
        self.links = {link.get("name"): link for link in root.findall("link")}
        self.joints = {joint.get("name"): joint for joint in root.findall("joint")}
        for name, joint in list(self.joints.items()):
            if joint.get("type") == "floating":
                del self.joints[name], self.links[joint.find("parent").get("link")]
        children = {joint.find("child").get("link") for joint in self.joints.values()}
        (self.root,) = self.links.keys() - children

    def poses(self, values):
        """(4, 4) of every link in the frame of the root, joint values by name."""
        found = {self.root: np.eye(4)}
        while len(found) < len(self.links):
            for name, joint in self.joints.items():
                parent, child = (joint.find(end).get("link") for end in ("parent", "child"))
                if parent in found and child not in found:
                    found[child] = found[parent] @ pose(joint) @ self.moved(name, values)
        return found

    def moved(self, name, values):
        joint, result = self.joints[name], np.eye(4)
        if joint.get("type") == "fixed":
            return result
        axis = joint.find("axis")
        axis = plain("1 0 0" if axis is None else axis.get("xyz"))
        axis = axis / np.linalg.norm(axis)
        if joint.get("type") == "prismatic":
            result[:3, 3] = values[name] * axis
        else:
            result[:3, :3] = about(axis, values[name])
        return result

    def body(self, name):
        """Mass, centre in the link's frame, and tensor about it in the link's axes."""
        inertial = self.links[name].find("inertial")
        if inertial is None:
            return 0.0, np.zeros(3), np.zeros((3, 3))
        at, tensor = pose(inertial), np.zeros((3, 3))
        for (i, a), (j, b) in [(p, q) for p in enumerate("xyz") for q in enumerate("xyz")]:
            key = "i" + "".join(sorted(a + b))
            (tensor[i, j],) = plain(inertial.find("inertia").get(key))
        (mass,) = plain(inertial.find("mass").get("value"))
        return mass, at[:3, 3], at[:3, :3] @ tensor @ at[:3, :3].T

    def whole(self, values):
        """Mass, centre and tensor about it of the whole robot, in the frame of the root."""
        poses, parts = self.poses(values), []
        for name, at in poses.items():
            mass, center, tensor = self.body(name)
            rotation = at[:3, :3]
            parts.append((mass, rotation @ center + at[:3, 3], rotation @ tensor @ rotation.T))
        mass = sum(part[0] for part in parts)
        center = sum(m * c for m, c, _ in parts) / mass
        tensor = np.zeros((3, 3))
        for m, c, own in parts:
            d = c - center
            tensor += own + m * (d @ d * np.eye(3) - np.outer(d, d))
        return mass, center, tensor

    def limits(self, name):
        """Lower, upper, velocity and effort of a joint."""
        limit = self.joints[name].find("limit")
        if limit is None:
            return -np.inf, np.inf, np.inf, np.inf
        read = [plain(limit.get(key), "0")[0] for key in ("lower", "upper", "velocity", "effort")]
        if self.joints[name].get("type") == "continuous":
            read[:2] = -np.inf, np.inf
        return tuple(read)

    def shapes(self):
        """Link, number, tag, sizes and placement in the link's frame of all collision shapes."""
        for name, link in self.links.items():
            for k, collision in enumerate(link.findall("collision")):
                (solid,) = collision.find("geometry")
                keys = {"box": ("size",), "sphere": ("radius",)}.get(
                    solid.tag, ("radius", "length")
                )
                sizes = np.concatenate([plain(solid.get(key)) for key in keys])
                yield name, k, solid.tag, sizes, pose(collision)
