"""Lines of keep-in zones lie where the zones end."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.display.scenes.shape_outlines import unit_normals
from ffsr_plan.display.scenes.zone_outlines import (
    ZONE,
    dashed,
    flat_zone,
    legend_of,
    lines_of,
    name_places,
    patch,
    sides_of,
)
from ffsr_plan.scene.shapes.keep_in_zones import planes_of

LOW, HIGH = np.array([-1.0, -2.0, -0.5]), np.array([5.0, 2.0, 0.5])
PICTURE = np.array([[-4.0, -3.0], [6.0, -3.0], [6.0, 3.0], [-4.0, 3.0]])
PLANES = [[1.0, 0.0, 0.0], [0.3, -0.8, 0.0], [0.2, 0.5, -2.0]]


@pytest.mark.parametrize("direction", PLANES)
def test_the_piece_of_a_plane_spans_what_is_shown_and_faces_outwards(direction):
    zone = fp.HalfSpace(direction, [2.0, 0.3, 0.1])
    (plane,) = planes_of(zone)
    corners = patch(zone, LOW, HIGH)
    assert 3 <= len(corners) <= 6
    assert np.allclose(corners @ plane[:3], plane[3])
    assert np.all((corners >= LOW - 0.7) & (corners <= HIGH + 0.7))
    triangles = sides_of(zone, LOW, HIGH)
    assert np.allclose(unit_normals(triangles), plane[:3])
    lines = lines_of(zone, LOW, HIGH)
    assert np.allclose(lines.segments[:, 1], np.roll(lines.segments[:, 0], -1, axis=0))


def test_a_plane_is_drawn_where_it_is_near_and_not_where_it_is_far():
    assert len(patch(fp.HalfSpace([0, 0, -1], [0, 0, -0.9]), LOW, HIGH)) == 4
    far = fp.HalfSpace([0, 0, -1], [0, 0, -9.0])
    assert patch(far, LOW, HIGH).shape == (0, 3)
    assert sides_of(far, LOW, HIGH).shape == (0, 3, 3)
    assert len(lines_of(far, LOW, HIGH).segments) == 0


def test_lines_of_a_box_are_its_twelve_edges():
    turn = [0.4, 0.2, -0.3]
    lines = lines_of(fp.Box([1.0, 2.0, 4.0], [1.0, 2.0, 3.0], turn), LOW, HIGH)
    lengths = np.linalg.norm(lines.segments[:, 1] - lines.segments[:, 0], axis=1)
    assert np.allclose(np.sort(lengths), [1.0] * 4 + [2.0] * 4 + [4.0] * 4)
    local = (lines.segments - [1.0, 2.0, 3.0]) @ rotations.matrix(rotations.from_angles(turn))
    assert np.allclose(np.abs(local), [0.5, 1.0, 2.0])
    assert np.all(np.sum((lines.segments.mean(axis=1) - [1, 2, 3]) * lines.outward, axis=1) > 0.5)


def test_lines_of_a_ball_lie_on_it():
    lines = lines_of(fp.Ball(2.0, [1.0, 2.0, 3.0]), LOW, HIGH)
    assert np.allclose(np.linalg.norm(lines.segments - [1.0, 2.0, 3.0], axis=2), 2.0)
    lengths = np.linalg.norm(lines.segments[:, 1] - lines.segments[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(3.0 * 0.5 * 4.0 * np.pi, rel=1e-2)  # half of it is gaps


def test_dashes_begin_and_end_with_their_line_and_cover_about_half():
    segments = np.array([[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]], [[0.0, 0.0, 0.0], [0.0, 0.01, 0.0]]])
    dashes = dashed(segments, 4.0)
    long = dashes[dashes[:, 1, 0] > 0.0]
    assert np.allclose([long[0, 0], long[-1, 1]], segments[0])
    assert np.sum(long[:, 1, 0] - long[:, 0, 0]) == pytest.approx(2.0, rel=0.05)
    assert np.allclose(dashes[-1], segments[1])
    assert dashed(segments[:0], 4.0).shape == (0, 2, 3)


def test_a_plane_seen_edge_on_halves_the_picture():
    zone = flat_zone(fp.HalfSpace([1.0, 0.5, 0.0], [2.0, 0.0, 0.0]), np.eye(3), 7.0, PICTURE)
    assert zone.certain
    assert np.allclose(zone.border @ [1.0, 0.5], 2.0)
    assert np.max(zone.inside @ [1.0, 0.5]) == pytest.approx(2.0)
    assert {tuple(corner) for corner in PICTURE[[0, 3]]} <= {tuple(k) for k in zone.inside}
    assert not {tuple(corner) for corner in PICTURE[[1, 2]]} & {tuple(k) for k in zone.inside}


def test_a_plane_through_corners_is_drawn_as_well():
    diagonal = fp.HalfSpace([1.0, -1.0, 0.0])
    high = np.array([1.0, 1.0 / 0.84, 1.0])  # with what is drawn beyond it, as long as wide
    corners = patch(diagonal, -high, high)
    assert len(corners) >= 4
    assert np.allclose(corners[:, 0], corners[:, 1])
    assert np.all(np.ptp(corners, axis=0) > 2.0)
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    zone = flat_zone(diagonal, np.eye(3), 0.0, square)
    assert np.allclose(np.sort(zone.border, axis=0), [[-1.0, -1.0], [1.0, 1.0]])


def test_an_oblique_plane_is_cut_at_a_height_and_hides_nothing_for_certain():
    zone = flat_zone(fp.HalfSpace([1.0, 0.0, 1.0], [2.0, 0.0, 0.0]), np.eye(3), 0.5, PICTURE)
    assert not zone.certain
    assert np.allclose(zone.border[:, 0], 1.5)


def test_planes_that_picture_shows_nothing_of_are_left_out():
    assert flat_zone(fp.HalfSpace([0, 0, 1.0]), np.eye(3), 0.0, PICTURE) is None
    assert flat_zone(fp.HalfSpace([1.0, 0, 0], [90, 0, 0]), np.eye(3), 0.0, PICTURE) is None


def test_a_box_and_a_ball_are_their_outlines():
    box = flat_zone(fp.Box([2.0, 1.0, 9.0], [1.0, 0.0, 0.0]), np.eye(3), 0.0, PICTURE)
    assert np.allclose(np.sort(box.inside, axis=0), [[0, -0.5], [0, -0.5], [2, 0.5], [2, 0.5]])
    assert np.allclose(box.border[0], box.border[-1])
    ball = flat_zone(fp.Ball(2.0), np.eye(3), 0.0, PICTURE)
    assert np.allclose(np.linalg.norm(ball.inside, axis=1), 2.0)
    assert box.certain
    assert ball.certain


def test_legends_and_names_are_those_of_the_zones():
    zones = [
        fp.Box([2.0, 2.0, 2.0], name="hall"),
        fp.Ball(3.0),
        fp.HalfSpace([1, 0, 0], [90, 0, 0]),
    ]
    assert legend_of(zones, ZONE, 60) == f"{ZONE}: hall"
    assert legend_of(zones[1:], ZONE, 60) == ZONE
    names = [fp.Ball(1.0, name=name) for name in ("communication range", "deck")]
    assert legend_of(names, ZONE, 22) == f"{ZONE}:\ncommunication range,\ndeck"
    assert legend_of(zones, "stay here", 3) == "stay here"
    ((name, at),) = name_places(zones, LOW, HIGH)
    assert name == "hall"
    assert np.allclose(at, [1.0, 1.0, 1.0])
