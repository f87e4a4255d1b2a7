"""Messages on what the drives leave unobservable."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from six_wheel.calibration.drives import RESTED, Drive, at_rest
from six_wheel.calibration.fitting import KNOWN, OPEN, openness
from six_wheel.calibration.model import Model
from six_wheel.calibration.problem import Solution
from six_wheel.kinematics.poses import Floats

# Parts of a direction smaller than this are not worth a word.
WORTH_A_WORD = 0.1
# A value that went less far than this share of what is plausible has stayed where it was.
MOVED = 1e-4
# A drive that turns less than this is called straight [rad].
STRAIGHT = 0.35
# Parameters whose values go together this closely are named.
TOGETHER = 0.95
# ... unless both are known to this share of what is plausible anyway.
WELL_KNOWN = 0.01
# Share of its way within which a drive is where it was.
RETURNED = 1e-3
NO_FARTHER = "they moved from their nominal values no farther than the data ask"


@dataclass(frozen=True, eq=False)
class Observability:
    """Identifiability of the parameters by the drives.

    Attributes
    ----------
    names : tuple of str
        The parameters.
    identified : ndarray of bool, shape (p,)
        True if the data tell this one by itself.
    directions : ndarray, shape (p, k)
        Combinations that nothing in the data depends on, in units of what is plausible for each.
    spread : ndarray, shape (p,)
        Change of each independent direction that may go unnoticed, in the same units, the best known first.
    messages : tuple of str
        The same in words.
    """

    names: tuple[str, ...]
    identified: NDArray[np.bool_]
    directions: Floats
    spread: Floats
    messages: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """True if every parameter is identified."""
        return bool(self.identified.all())

    def __repr__(self) -> str:
        return "Observability(" + ("; ".join(self.messages) or "everything is identified") + ")"


def told(drives: Sequence[Drive]) -> list[str]:
    """Messages on what truths of less than poses leave open, and on times at a standstill."""
    said = []
    if any(not drive.truth.has_yaw for drive in drives):
        said.append(
            "positions alone tell no heading: which way the sensor faces and how far off a run ends are not "
            "known, errors are after the best rigid alignment"
        )
    if any(not drive.truth.has_positions for drive in drives):
        said.append(
            "a gyroscope alone tells turns and no distances: ratios of lengths, no scale; "
            "errors are of headings [rad]"
        )
    if all(_returns(drive) for drive in drives):
        said.append("a closed loop alone tells ratios of lengths, as of track to radius, and no scale")
    for drive in drives:
        rest, whole = float(drive.dt[at_rest(drive.wheel_speeds)].sum()), float(drive.dt.sum())
        if rest >= RESTED:
            said.append(
                f"{drive.name} stands for {rest:.1f} s of {whole:.1f} s, which tells nothing: left out"
            )
    return said


def _returns(drive: Drive) -> bool:
    """True if a drive's truth only says that it returned to the same place."""
    if not drive.truth.has_positions or np.diff(drive.truth.stamps).min() <= drive.truth.max_gap:
        return False
    places = drive.truth.poses[:, :2]
    return float(np.ptp(places, axis=0).max()) <= RETURNED * drive.distance


def describe(
    model: Model, solution: Solution, drives: Sequence[Drive], hints: Sequence[str] = ()
) -> Observability:
    """The open directions of a solution, and what they mean for each parameter; after other `hints`."""
    # Mounts of sessions are nobody's business: what only they leave open is left out.
    own = solution.unseen[: model.own]
    unseen = own[:, np.linalg.norm(own, axis=0) > MOVED]
    share = openness(unseen)
    identified = share < KNOWN
    messages = [
        _alone(model, solution, number, drives) for number in np.flatnonzero(share > 1.0 - KNOWN).tolist()
    ]
    mixed = np.flatnonzero(~identified & (share <= 1.0 - KNOWN))
    if len(mixed):
        messages.append(_together(unseen, mixed, model.names))
    messages += _correlated(model, solution, identified)
    names = model.names[: model.own]
    return Observability(names, identified, unseen, solution.spread[: model.own], (*hints, *messages))


def _alone(model: Model, solution: Solution, number: int, drives: Sequence[Drive]) -> str:
    parameter = model.parameters[number]
    turning = max(drive.turning for drive in drives)
    why = f"the drives do not tell it to {OPEN * parameter.plausible:.3g} {parameter.unit}".rstrip()
    if turning < STRAIGHT:
        why = f"a straight run cannot identify it (turned {np.degrees(turning):.1f} deg at most)"
    value, unit = float(solution.values[number]), f" {parameter.unit}".rstrip()
    if abs(value - parameter.value) <= MOVED * parameter.plausible:
        return f"{parameter.name} stays at its nominal {parameter.value:.6g}{unit}: {why}"
    moved = f"{parameter.name} went from {parameter.value:.6g} to {value:.6g}{unit} along with others"
    return f"{moved}, by itself it is not known: {why}"


def _together(unseen: Floats, mixed: NDArray[np.int64], names: Sequence[str]) -> str:
    """Message on parameters that may stand for each other, or of which nothing is known."""
    listed = ", ".join(names[i] for i in mixed)
    count = int(np.linalg.matrix_rank(unseen[mixed], tol=WORTH_A_WORD))
    if count >= len(mixed):
        what = "neither by themselves nor together do the drives tell them"
        return f"{listed}: {what}; {NO_FARTHER}"
    some = "one combination" if count == 1 else f"{count} combinations"
    free = f"{some} of them could change unnoticed ({_simplest(unseen, mixed, names)})"
    return f"{listed} are identified only together: {free}; {NO_FARTHER}"


def _simplest(unseen: Floats, mixed: NDArray[np.int64], names: Sequence[str]) -> str:
    """The first open direction, as shares of what is plausible for each parameter."""
    part = unseen[mixed]
    direction = part[:, int(np.argmax(np.abs(part).max(axis=0)))]
    direction = direction / direction[np.argmax(np.abs(direction))]
    terms = [
        f"{value:+.2f} {names[i]}"
        for i, value in zip(mixed, direction, strict=True)
        if abs(value) > WORTH_A_WORD
    ]
    return " ".join(terms)


def _correlated(model: Model, solution: Solution, identified: NDArray[np.bool_]) -> list[str]:
    """Pairs that are identified but could nearly stand for each other."""
    kept = solution.seen.shape[1]
    root = (solution.seen * solution.spread[:kept])[: len(identified)]
    covariance = root @ root.T
    sizes = np.sqrt(np.diag(covariance))
    messages = []
    for first, second in combinations(np.flatnonzero(identified & (sizes > 0.0)).tolist(), 2):
        correlation = covariance[first, second] / (sizes[first] * sizes[second])
        if abs(correlation) > TOGETHER and max(sizes[first], sizes[second]) > WELL_KNOWN:
            pair = f"{model.names[first]} and {model.names[second]}"
            messages.append(f"{pair} are hard to tell apart here (correlation {correlation:+.2f})")
    return messages
