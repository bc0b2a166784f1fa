#!/bin/sh
# Makes .venv with the pinned packages, and the system packages that the wanted job needs.
# Usage: tools/set_up.sh reproduce|test
set -eu
cd "$(dirname "$0")/.."

# A reproduction is numba and simulated observers: pip brings all that it needs. The tests also need
# - LLVM, with which Mitsuba compiles its kernels (versions below 19 abort the process), and libatomic for Dr.Jit;
# - the observer's window: OpenGL and X for PsychoPy, a virtual screen and a scripted pointer, and one screen with a
#   gamma table.
wanted=""
if [ "${1:-reproduce}" = test ]; then
    wanted="libllvm19 libatomic1
        libgl1 libglu1-mesa libgl1-mesa-dri libx11-6 libxext6 libxxf86vm1 libxinerama1 libxi6 libegl1
        libglib2.0-0 libfontconfig1 libdbus-1-3 fontconfig fonts-dejavu-core xvfb xauth xdotool
        xserver-xorg-core xserver-xorg-video-dummy
        libxkbcommon-x11-0 libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0"
fi

python=""
for candidate in python3.12 python3.11 python3; do
    if command -v "$candidate" >/dev/null 2>&1 &&
        "$candidate" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 13))' 2>/dev/null; then
        python=$candidate
        break
    fi
done
if [ -z "$python" ]; then
    echo "glossspace needs Python 3.11 or 3.12, and found neither. On Debian 12: apt-get install python3 python3-venv" >&2
    exit 2
fi
"$python" -c 'import ensurepip, venv' 2>/dev/null || wanted="$wanted $(basename "$(readlink -f "$(command -v "$python")")")-venv"

if command -v dpkg-query >/dev/null 2>&1; then
    missing=""
    for package in $wanted; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q '^install ok installed' || missing="$missing $package"
    done
    if [ -n "$missing" ]; then
        if [ "$(id -u)" = 0 ]; then
            as_root=""
        elif sudo -n true 2>/dev/null; then
            as_root="sudo"
        else
            echo "Please install these system packages, then run make again: sudo apt-get install$missing" >&2
            exit 2
        fi
        echo "Installing system packages:$missing" >&2
        $as_root apt-get update -qq
        # shellcheck disable=SC2086 # the list is meant to be split
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
    fi
else
    [ -z "$wanted" ] || echo "This is no Debian system: make sure that it has the counterparts of: $wanted" >&2
fi

stamp=.venv/.complete
if [ ! -f "$stamp" ] || [ requirements.lock -nt "$stamp" ] || [ pyproject.toml -nt "$stamp" ]; then
    echo "Installing Python packages into .venv (1.5 GB; a few minutes)" >&2
    rm -f "$stamp"
    [ -x .venv/bin/python ] || "$python" -m venv --clear .venv
    # The lock file is complete and leaves out parts of PsychoPy on purpose, so nothing is resolved here.
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --use-pep517 -r requirements.lock
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
    touch "$stamp"
fi
