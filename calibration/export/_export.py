"""From a card's file to a program's folder."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from calibration._files import write_whole
from calibration.errors import InputError
from calibration.experiment import read
from calibration.experiment.model import CouponTrial, Experiment
from calibration.export import _readme, _registry
from calibration.export._convert import convert
from calibration.export._earlier import earlier_files, remove
from calibration.export._job import Job, Target, Written
from calibration.export._response import elastic, long_time
from calibration.export._scene import predict, scene_of, solve
from calibration.prediction._cards import BASE, CardFile, read_cards
from tisim import Material, laws

MOST_LOSS = 0.5  # of stress, rms
OWN = (
    0.005  # what a program's own tolerances and time steps may make of a beam, a fraction of its displacement
)
RANGE = (0.8, 1.25)  # principal stretches, where there is neither a scene nor a coupon


@dataclass(frozen=True, kw_only=True)
class Checked:
    """A scene that its program has run; fractions of the displacement of the beam's end in tisim.

    Attributes
    ----------
    from_reference : float
        How far its end is from that of the card's beam in tisim.
    from_expected : float
        From that of the program's law and mesh in tisim; NaN where tisim found none.
    limit : float
        How far that may be: what is stated of the program's element, and OWN for its tolerances.
    """

    from_reference: float
    from_expected: float
    limit: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Exported:
    """A card that was exported.

    Attributes
    ----------
    folder : Path
    files : tuple of Path
        README.md first.
    job : Job
        What was exported.
    lost : tuple of str
        What the program does not have, with its size, a sentence each.
    remarks : tuple of str
        On the program, the scene and the card.
    checked : Checked or None
        Where the program was run.
    """

    folder: Path
    files: tuple[Path, ...]
    job: Job
    lost: tuple[str, ...]
    remarks: tuple[str, ...]
    checked: Checked | None = None

    @property
    def within(self) -> bool:
        """True if the program that was run gave the expected beam, or none was run; False where none was
        expected."""
        return self.checked is None or self.checked.from_expected <= self.checked.limit


def export_card(
    card: str | Path,
    *,
    to: str,
    out: str | Path,
    law: str | None = None,
    experiment: str | Path | None = None,
    trial: str | None = None,
    scene: bool = True,
    refinement: float = 1.0,
    most_loss: float = MOST_LOSS,
    check: bool = False,
    overwrite: bool = False,
) -> Exported:
    """Write a material card for another program.

    Parameters
    ----------
    card : path
        MATERIAL.yaml.
    to : str
        One of `calibration.export.names()`.
    out : path
        Folder to write: new or empty.
    law : str, optional
        One of the card's laws; the one that it names where left out.
    experiment : path, optional
        Folder with experiment.yaml, whose beam is the scene; the paper's beam where left out.
    trial : str, optional
        Its id; the first beam of the card's material where left out.
    scene : bool
        Write the beam as well.
    refinement : float
        Elements of the scene get smaller by this factor, 0.3 to 4.
    most_loss : float
        Largest rms difference of stress, as a fraction, at which another law may stand for the card's.
    check : bool
        Run the program on the scene.
    overwrite : bool
        Write into a folder that is not empty: the files of an earlier export in it are replaced, others stay.

    Returns
    -------
    Exported

    Raises
    ------
    InputError
        One sentence: a card, a program, an experiment or a folder that cannot be used; a law that has no
        counterpart; with `check`, a program that is not there or finds no equilibrium.
    """
    folder = Path(out)
    try:
        target = _registry.get(to)
    except ValueError as error:
        raise InputError(f"--to {to}: {error}") from None
    if not 0.3 <= refinement <= 4.0:
        raise InputError(f"--refinement {refinement:g}: expected a factor of 0.3 to 4")
    if trial is not None and not scene:
        raise InputError(f"--trial {trial}: expected a scene, which --no-scene leaves out")
    if not most_loss > 0.0:
        raise InputError(f"--most-loss {most_loss:g}: expected a fraction above 0")
    if check and (target.check is None or not scene):
        able = ", ".join(n for n in _registry.names() if _registry.get(n).check)
        raise InputError(f"--check: expected a scene for one of {able}, which can be run from here")
    if folder.exists() and not folder.is_dir():
        raise InputError(f"--out {folder}: expected a folder, found a file")
    if folder.is_dir() and any(folder.iterdir()) and not overwrite:
        raise InputError(f"--out {folder}: expected an empty folder; add --overwrite to write into it")
    file, material = _material(Path(card), law)
    measured = None if experiment is None else read(Path(experiment))
    if measured is not None and file.material not in measured.materials:
        known = ", ".join(measured.materials)
        raise InputError(f"--experiment {experiment}: expected material {file.material}, it has {known}")
    named = "" if measured is None else measured.name
    weighed = None if measured is None else measured.materials[file.material].density
    if weighed is not None:
        material = replace(material, density=weighed)
    made, notes, high = _job(file, material, target, measured, trial, scene, refinement, most_loss)
    if weighed is not None and weighed != file.density:
        notes.append(
            f"density {weighed:g} kg/m3, as experiment {named!r} states it; the card has {file.density:g}"
        )
    lost = _readme.losses(made, high)
    folder.mkdir(parents=True, exist_ok=True)
    earlier = earlier_files(folder)
    written = target.write(made, folder)
    remove(earlier, keep=written.files)
    path = folder / "README.md"  # last: until then the earlier one names the files to remove
    write_whole(path, _readme.readme(made, target, written, lost, notes))
    remarks = [*written.remarks, *_readme.scene_lines(made, target), *notes]
    checked = _check(made, target, folder) if check else None
    return Exported(
        folder=folder, files=(path, *written.files), job=made, lost=tuple(lost), remarks=tuple(remarks),
        checked=checked,
    )  # fmt: skip


def _material(path: Path, law: str | None) -> tuple[CardFile, Material]:
    if not path.is_file():
        raise InputError(f"{path}: expected a material card (MATERIAL.yaml)")
    ((_, file),) = read_cards(path).items()
    name = law or file.law or BASE
    if name not in file.laws:
        raise InputError(f"--law {name}: expected one of the card's: {', '.join(file.laws)}")
    try:
        laws.get(name).check(file.laws[name])
        parts = file.parts()
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    return file, Material(law=name, parameters=file.laws[name], density=file.density, **parts)  # type: ignore[arg-type]


def _job(
    file: CardFile, material: Material, target: Target, experiment: Experiment | None, trial: str | None,
    with_scene: bool, refinement: float, most_loss: float,
) -> tuple[Job, list[str], float]:  # fmt: skip
    """The job, notes on the card, and the largest stretch at which the law was compared."""
    material = long_time(material)
    plain = elastic(material)
    bare = replace(plain, fibres=None)
    notes = _notes(file, experiment)
    scene, low, high = None, *RANGE
    if with_scene:
        # fibres that the program lacks are not in tisim's beam either: their loss is a sentence of its own
        scene, more = scene_of(
            bare, target.element, experiment=experiment, trial=trial, refinement=refinement,
            material_name=file.material,
        )  # fmt: skip
        notes += more
        if scene.loaded and not target.tip_force:
            raise InputError(
                f"--to {target.name}: its scene file has no forces, and {scene.name} has a tip force: choose"
                " another --trial, or --no-scene"
            )
    coupons = [t for t in (experiment.trials if experiment else ()) if isinstance(t, CouponTrial)]
    pulled = [t for t in coupons if t.material == file.material and t.mode != "simple-shear"]
    if pulled:
        low = min(1.0, *(float(t.stretch.min()) for t in pulled))
        high = max(1.0, *(float(t.stretch.max()) for t in pulled))
        low, high = min(low, high**-0.5), max(high, 1.01)

    found = None if scene is None else solve(scene)
    if found is not None and not pulled:
        low, high = min(found.low, 0.99), max(found.high, 1.01)
    conversion = convert(
        bare,
        lambda form: target.writes(form, material),
        low=low,
        high=high,
        most_loss=most_loss,
        program=target.name,
        most_poisson=target.most_poisson,
    )
    keeps = frozenset(target.keeps(material, conversion.form))
    job = Job(name=file.material, material=material, conversion=conversion, keeps=keeps)
    if scene is None or found is None:
        return job, notes, high
    if "fibres" in keeps:
        scene = replace(scene, beam=replace(scene.beam, material=plain))
        found = solve(scene)
    prediction = predict(
        scene, found, job.form, replaced=conversion.how == "fit",
        element_error=target.element_share(refinement),
    )  # fmt: skip
    return replace(job, scene=scene, prediction=prediction), notes, high


def _notes(file: CardFile, experiment: Experiment | None) -> list[str]:
    found = []
    origin = file.origin
    if origin is not None and experiment is None:
        found.append(
            f"the card was calibrated on experiment {origin.experiment!r}: give --experiment FOLDER for a"
            " scene of its beam"
        )
    elif origin is not None and experiment is not None and not experiment.digest.startswith(origin.sha256):
        found.append(
            f"the card was calibrated on experiment {origin.experiment!r} (sha256 {origin.sha256[:16]}), the"
            f" scene is of {experiment.name!r} (sha256 {experiment.digest[:16]})"
        )
    left = [e for e in file.effects if not e.becomes]
    if left:
        sizes = "; ".join(
            f"{e.effect} ({', '.join(f'{n} {a.value:.4g} +- {a.sd:.2g}' for n, a in e.parameters.items())})"
            for e in left
        )
        found.append(f"effects that the card states beside its material are not exported: {sizes}")
    if file.uncertainty.shear_modulus_high is not None:
        found.append(
            f"the card's shear modulus is known to {100 * file.uncertainty.shear_modulus_high:.2g} % (95 %)"
        )
    return found


def _check(job: Job, target: Target, folder: Path) -> Checked:
    assert target.check is not None
    assert job.scene is not None
    assert job.prediction is not None
    moved = target.check(folder)
    if moved.shape != job.scene.mesh.nodes.shape:
        raise InputError(f"--check: expected {len(job.scene.mesh.nodes)} displacements, got {len(moved)}")
    end = moved[job.scene.watched].mean(axis=0)
    reference, expected = job.prediction.reference, job.prediction.expected
    size = float(np.linalg.norm(reference))
    return Checked(
        from_reference=float(np.linalg.norm(end - reference)) / size,
        from_expected=np.nan if expected is None else float(np.linalg.norm(end - expected)) / size,
        limit=OWN + target.element_share(job.scene.refinement),
    )


__all__ = ["Checked", "Exported", "Written", "export_card"]
