#!/usr/bin/env bash
# Writes docs/gallery.md and its pictures: five failing subjects as gonio shows them.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release --quiet
gonio=$PWD/target/release/gonio
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p docs/gallery
page=$scratch/gallery.md

# show NAME TITLE PICTURE TEXT ARGUMENTS…: a subject, the first block of what is told of
# it and the counts, one of its pictures, and what to see.
show() {
    local name=$1 title=$2 picture=$3 text=$4
    shift 4
    local told=$scratch/$name.txt code=0
    COLUMNS=100 "$gonio" check "$@" --out "$scratch/$name" --color never 2> "$told" || code=$?
    [ "$code" -eq 1 ] || { echo "$name ended with $code" >&2; exit 1; }
    cp "$scratch/$name/plots/$picture" "docs/gallery/$name.svg"
    {
        printf '\n## %s\n\n```text\n$ gonio check %s\n\n' "$title" "$*"
        awk '/^✗ fail/ { on = 1 } on && /^$/ { exit } on' "$told"
        printf '\n'
        grep -E '^([0-9]+ passed, )?[0-9]+ failed' "$told"
        printf '```\n\n![%s](gallery/%s.svg)\n\n%s\n' "$title" "$name" "$text"
    } >> "$page"
}

cat > "$page" << 'END'
# Failing subjects

Five of the mutants (`gonio list --mutants`): the command, the first block of what it
prints with the diagnosis, and one of the pictures that `--out DIR` writes. Made by
[gallery.sh](gallery.sh).
END

show no-jacobian 'pdf of the half vector' case-0000.svg \
    'Too few samples (blue) nearly everywhere, and too many (orange) beyond the mirror direction, where 4 wo·h < 1. [half-vector-jacobian](causes/half-vector-jacobian.md)' \
    mutant-no-jacobian:alpha=0.3 --theta 75 --phi 17

show share-forgotten 'A lobe without its probability' case-0000.svg \
    'The base has too few samples everywhere, by one factor; the coat around the mirror direction is right. [lobe-probability](causes/lobe-probability.md)' \
    mutant-one-share-forgotten:alpha=0.15 --theta 60 --phi 17

show eta-squared 'Rough glass with one η² too many' case-0000.svg \
    'What is reflected (above) is right; what is transmitted (below) is η² times too probable in pdf, all over the side. [refraction-jacobian](causes/refraction-jacobian.md)' \
    mutant-eta-squared-in-pdf --theta 60 --phi 17 --transport radiance

show masking 'Masking without shadowing' case-0000-reciprocity.svg \
    'Samples follow pdf and weights fit: only exchanging wo and wi shows it, most where wi grazes and its missing G1 would be small. [masking](causes/masking.md)' \
    mutant-masking-of-wo-only --theta 60 --phi 17 --check reciprocity

show compensation 'Energy compensation at one angle' albedo-mutant-loss-of-incident-twice.svg \
    'A lossless surface has the albedo 1 at every angle. This one takes what is lost at wi for both directions: too dark from above, too bright towards the horizon. [energy-compensation](causes/energy-compensation.md)' \
    mutant-loss-of-incident-twice --theta 0 --theta 30 --theta 60 --theta 75 --theta 85 --phi 17

mv "$page" docs/gallery.md
