"""Rotations: Eq. 2 as corrected, and the algebra behind everything that turns."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations

angles = st.tuples(*[st.floats(-3.1, 3.1)] * 3).map(np.array)
gentle = st.tuples(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3)).map(np.array)


@given(gentle)
def test_equation_2_with_its_misprint_corrected(abc):
    a, b, c = abc
    sa, ca, sb, cb, sc, cc = np.sin(a), np.cos(a), np.sin(b), np.cos(b), np.sin(c), np.cos(c)
    expected = [
        [ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc],
        [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc],  # printed s_a s_b
        [-sb, cb * sc, cb * cc],
    ]
    assert np.allclose(rotations.matrix(rotations.from_angles(abc)), expected, atol=1e-14)


@given(gentle)
def test_angles_and_quaternions_are_each_others_inverse(abc):
    q = rotations.from_angles(abc)
    back = rotations.from_angles(rotations.to_angles(q))
    assert rotations.angle_between(q, back) < 1e-7
    assert np.allclose(rotations.matrix(q), rotations.matrix(back), atol=1e-12)


@pytest.mark.parametrize("beta", [np.pi / 2, -np.pi / 2])
def test_angles_at_the_singularity_give_the_same_attitude(beta):
    q = rotations.from_angles(np.array([0.4, beta, -0.9]))
    assert np.allclose(
        rotations.matrix(rotations.from_angles(rotations.to_angles(q))),
        rotations.matrix(q),
        atol=1e-8,
    )


@given(angles, angles)
def test_the_algebra_agrees_with_pinocchio(phi, psi):
    p, q = rotations.exp(phi), rotations.exp(psi)
    assert np.allclose(rotations.matrix(p), pin.exp3(phi), atol=1e-13)
    assert np.allclose(rotations.matrix(rotations.multiply(p, q)), pin.exp3(phi) @ pin.exp3(psi))
    assert np.allclose(rotations.matrix(rotations.inverse(p)), pin.exp3(phi).T)


@given(angles, st.floats(1e-14, 1.0))
def test_log_inverts_exp_near_the_identity_too(phi, scale):
    small = phi * scale / max(np.linalg.norm(phi), 1.0)
    assert np.allclose(rotations.log(rotations.exp(small)), small, rtol=1e-12, atol=1e-16)


@given(angles, angles, st.floats(0, 1))
def test_slerp_has_constant_angular_velocity(phi, psi, s):
    p, q = rotations.exp(phi), rotations.exp(psi)
    whole = rotations.angle_between(p, q)
    assert whole <= np.pi + 1e-12
    part = rotations.angle_between(p, rotations.slerp(p, q, np.array(s)))
    assert part == pytest.approx(s * whole, abs=1e-7)


@given(gentle, st.tuples(*[st.floats(-1, 1)] * 3).map(np.array))
def test_the_angle_rate_matrix_matches_finite_differences(abc, rate):
    h = 1e-6
    before = rotations.from_angles(abc - h * rate)
    after = rotations.from_angles(abc + h * rate)
    measured = rotations.log(rotations.multiply(rotations.inverse(before), after)) / (2 * h)
    assert np.allclose(rotations.angle_rate_matrix(abc) @ rate, measured, atol=1e-8)


def test_the_singular_angle_rate_matrix_is_refused():
    with pytest.raises(fp.InvalidInput, match="singular"):
        rotations.angle_rate_matrix(np.array([0.0, np.pi / 2, 0.0]))


def half_turns(count=4000):
    """Pairs of attitudes half a turn apart, axes and pairs of axes of the base among the axes."""
    rng = np.random.default_rng(5)
    axes = rng.normal(size=(count, 3))
    axes[:: count // 40] = np.round(axes[:: count // 40])  # zeros, ones and twos
    axes = axes[np.linalg.norm(axes, axis=1) > 0.0]
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    p = rotations.exp(rng.uniform(-3.0, 3.0, axes.shape))
    return p, rotations.multiply(p, np.hstack([axes, np.zeros((len(axes), 1))])), rng


def test_a_half_turn_has_one_sense_whatever_the_rounding():
    p, q, rng = half_turns()
    vectors = rotations.rotation_vector(p, q)
    for _ in range(20):
        rounded = [each + rng.uniform(-4e-16, 4e-16, each.shape) for each in (p, q)]
        signs = rng.choice([-1.0, 1.0], (2, len(p), 1))  # q and -q are one attitude
        again = rotations.rotation_vector(signs[0] * rounded[0], signs[1] * rounded[1])
        assert np.allclose(again, vectors, atol=1e-14)
    leading = vectors[np.arange(len(p)), np.argmax(np.abs(vectors) > 1e-5, axis=1)]
    assert np.all(leading > 0.0)
    there = rotations.multiply(p, rotations.exp(vectors))
    assert np.max(rotations.angle_between(there, q)) < 1e-14


@given(angles, angles)
def test_other_rotations_take_the_smaller_angle(phi, psi):
    p, q = rotations.exp(phi), rotations.exp(psi)
    expected = rotations.log(rotations.multiply(rotations.inverse(p), q))
    if np.linalg.norm(expected) < np.pi - 1e-6:
        assert np.array_equal(rotations.rotation_vector(p, q), expected)
