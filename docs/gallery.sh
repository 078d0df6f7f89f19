#!/usr/bin/env bash
# Writes docs/gallery.md and its pictures: seven failing subjects as gonio shows them.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release --quiet
gonio=$PWD/target/release/gonio
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p docs/gallery
page=$scratch/gallery.md

# show NAME TITLE ARGUMENTS…: a subject, the first block of what is told of it, and the
# counts.
show() {
    name=$1
    local title=$2
    shift 2
    local told=$scratch/$name.txt code=0
    COLUMNS=100 "$gonio" check "$@" --out "$scratch/$name" --color never 2> "$told" || code=$?
    [ "$code" -eq 1 ] || { echo "$name ended with $code" >&2; exit 1; }
    {
        printf '\n## %s\n\n```text\n$ gonio check %s\n\n' "$title" "$*"
        awk '/^✗ fail/ { on = 1 } on && /^$/ { exit } on' "$told"
        printf '\n'
        grep -E '^([0-9]+ passed, )?[0-9]+ failed' "$told"
        printf '```\n'
    } >> "$page"
}

# picture FILE SUFFIX ALT TEXT: one of the pictures of the subject shown last, and what
# to see.
picture() {
    cp "$scratch/$name/plots/$1" "docs/gallery/$name$2.svg"
    printf '\n![%s](gallery/%s.svg)\n\n%s\n' "$3" "$name$2" "$4" >> "$page"
}

cat > "$page" << 'END'
# Failing subjects

Seven of the mutants (`gonio list --mutants`): the command, the first block of what it
prints with the diagnosis, and some of the pictures that `--out DIR` writes, each kind
once. Made by [gallery.sh](gallery.sh).
END

show no-jacobian 'pdf of the half vector' mutant-no-jacobian:alpha=0.3 --theta 75 --phi 17
picture case-0000.svg '' 'Samples, pdf and their difference' \
    'On equal-area discs: too few samples (blue) nearly everywhere, and too many (orange) beyond the mirror direction, where 4 wo·h < 1. [half-vector-jacobian](causes/half-vector-jacobian.md)'
picture case-0000-plane.svg -plane 'Samples over pdf along the plane of incidence' \
    'Along the plane of incidence the ratio follows what the diagnosis predicts, 4 wo·h.'

show share-forgotten 'A lobe without its probability' \
    mutant-one-share-forgotten:alpha=0.15 --theta 60 --phi 17
picture case-0000.svg '' 'Samples, pdf and their difference' \
    'The base has too few samples everywhere, by one factor; the coat around the mirror direction is right. [lobe-probability](causes/lobe-probability.md)'

show eta-squared 'Rough glass with one η² too many' \
    mutant-eta-squared-in-pdf --theta 60 --phi 17 --transport radiance
picture case-0000-lobe.svg '' 'The lobe in the plane of incidence' \
    'What is reflected (above) is right: samples lie on pdf. What is transmitted (below) is η² times too probable in pdf, all over the side. [refraction-jacobian](causes/refraction-jacobian.md)'

show not-turned-back 'A lobe that is not turned back' \
    mutant-lobe-not-turned-back --theta 60 --phi 17 --phi 137 --phi 257
picture case-0000-azimuth.svg '' 'Samples over pdf by azimuth' \
    'At φo = 17° hardly anything is wrong; at the other two azimuths of wo the samples lie turned by φo. [frame](causes/frame.md)'

show weight-without-share 'A weight without the lobe'"'"'s probability' \
    mutant-weight-without-share --theta 60 --phi 17
picture case-0000-weights.svg '' 'Weights of samples' \
    'The heaviest sample has about half of the largest f·|cos θi|/pdf that the cubature met: no weight may end there. [weight](causes/weight.md)'

show masking 'Masking without shadowing' \
    mutant-masking-of-wo-only --theta 60 --phi 17 --check reciprocity
picture case-0000-reciprocity.svg '' 'Reciprocity' \
    'Samples follow pdf and weights fit: only exchanging wo and wi shows it, most where wi grazes and its missing G1 would be small. [masking](causes/masking.md)'

show compensation 'Energy compensation at one angle' \
    mutant-loss-of-incident-twice --theta 0 --theta 30 --theta 60 --theta 75 --theta 85 --phi 17
picture furnace-mutant-loss-of-incident-twice.svg '' 'Flux against angle' \
    'A lossless surface gives back all flux at every angle. This one takes what is lost at wi for both directions: too dark from above, too bright towards the horizon. [energy-compensation](causes/energy-compensation.md)'
picture albedo-mutant-loss-of-incident-twice.svg -albedo 'Albedo against angle' \
    'The weights of samples have the mean that the integral says: sample() and eval() agree, and are both wrong.'

mv "$page" docs/gallery.md
