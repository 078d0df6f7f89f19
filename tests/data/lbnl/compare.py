"""Compares gonio's sums over the files of this folder (or those named) with what
Radiance's checkBSDF prints of them; ends with 1 where they differ by more than
checkBSDF rounds and perturbs.

    pip install pyradiance
    cargo build --release --example table_survey
    python3 tests/data/lbnl/compare.py

checkBSDF prints the largest total of each incident patch, exact for matrices and
for trees of cells not finer than 1/32; and |a − b| / max(a, b) over pairs: of all
patches of a matrix where both values exceed 1e-4 /sr (least, mean, most), and at
random points of a tree, which has no exact figure to compare. Radiance changes the
values that it looks up by up to 0.03 %, so that equal ones differ.
"""

import json
import subprocess
import sys
from pathlib import Path

import pyradiance

HERE = Path(__file__).parent
SURVEY = HERE.parents[2] / "target/release/examples/table_survey"
CHECK = Path(pyradiance.__file__).parent / "bin/checkBSDF"
# checkBSDF's names and those of this project's frame.
FLUX = {
    "Interior Refl": "front reflection",
    "Exterior Refl": "back reflection",
    "Int->Ext Trans": "front transmission",
    "Ext->Int Trans": "back transmission",
}
ASYMMETRY = {"Interior Refl": "front reflection", "Exterior Refl": "back reflection", "Transmission": "transmission"}


def theirs(path: Path) -> tuple[str, dict, dict]:
    text = subprocess.run([CHECK, path], capture_output=True, text=True, check=True).stdout
    kind = next(line.split()[1] for line in text.splitlines() if line.startswith("Type:"))
    first, second = text.split("Component\tReciprocity")
    flux = {}
    for line in first.splitlines():
        name, _, rest = line.partition("\t")
        if name in FLUX:
            flux[name] = float(rest.split("\t\t")[1].strip().rstrip("%")) / 100
    asymmetry = {}
    for line in second.splitlines()[1:]:
        name, *figures = line.split("\t")
        asymmetry[name] = [float(f) / 100 for f in figures]
    return kind, flux, asymmetry


def main() -> int:
    wrong = 0
    for path in [Path(a) for a in sys.argv[1:]] or sorted(HERE.glob("*.xml")):
        ours = json.loads(subprocess.run([SURVEY, path], capture_output=True, text=True, check=True).stdout)
        kind, flux, asymmetry = theirs(path)
        print(f"{path.name} ({kind})")
        print(f"  {'most flux':20} {'gonio':>10} {'checkBSDF':>10}")
        for name, own in FLUX.items():
            a, b = ours["most flux"][own], flux[name]
            # What the file lacks and gonio takes from the other side, checkBSDF leaves out.
            known = b > 0 or a == 0
            bad = known and abs(a - b) > 0.00055
            wrong += bad
            print(f"  {own:20} {a:10.5f} {b:10.3f}{'  DIFFERS' if bad else '' if known else '  (not in the file)'}")
        print(f"  {'asymmetry':20} {'gonio: least mean most':>30} {'checkBSDF':>24}")
        for name, own in ASYMMETRY.items():
            a, b = ours["asymmetry"][own], asymmetry[name]
            if a is None:
                print(f"  {own:20} {'(no matrix)':>30} {b}")
                continue
            both = any(b) or not any(a)
            bad = both and any(abs(x - y) > 0.0009 for x, y in zip(a, b))
            wrong += bad
            print(f"  {own:20} {' '.join(f'{x:9.5f}' for x in a):>30} {b}{'  DIFFERS' if bad else ''}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
