# Sourced by scripts/demo and scripts/test: makes the environment in .venv, and a GL driver.
# Needs python3 (3.11 or newer); as root on Debian it installs what else is missing.

say() { printf '%s\n' "$*" >&2; }
is_root() { [ "$(id -u)" = 0 ]; }

apt_install() {
    say "installing from Debian: $*"
    apt-get update -qq >/dev/null && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$@" >/dev/null
}

make_environment() { # make_environment EXTRAS
    local python=${PYTHON:-python3} stamp
    if ! command -v "$python" >/dev/null; then
        say "python3 is missing: apt-get install python3 python3-venv"
        return 1
    fi
    if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
        say "Python 3.11 or newer is needed; this is $("$python" --version). Set PYTHON to another one."
        return 1
    fi
    if [ ! -x .venv/bin/pip ]; then
        if ! "$python" -m venv .venv >/dev/null 2>&1; then
            rm -rf .venv
            if is_root && command -v apt-get >/dev/null; then
                apt_install python3-venv
                "$python" -m venv .venv
            else
                say "the module venv is missing: as root, apt-get install python3-venv"
                return 1
            fi
        fi
    fi
    stamp=".venv/installed-$1-$(cksum < pyproject.toml | cut -d' ' -f1)"
    if [ ! -e "$stamp" ]; then
        say "installing Python packages into .venv"
        .venv/bin/pip install --quiet --disable-pip-version-check -e ".$1"
        : > "$stamp"
    fi
}

has_opengl() {
    opengl_problem=$(.venv/bin/python -c 'from nau_py.raster.device import get_device; get_device()' 2>&1)
}

make_opengl() {
    has_opengl && return 0
    if is_root && command -v apt-get >/dev/null; then
        apt_install libegl1 libgl1 libgl1-mesa-dri
        has_opengl && return 0
    fi
    say "$opengl_problem"
    say "no OpenGL 4.5 driver was found. Mesa's draws without a GPU; as root:"
    say "    apt-get install libegl1 libgl1 libgl1-mesa-dri"
    return 1
}
