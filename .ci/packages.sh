# Examples/quickstart.sh and Testing/run-tests.sh source this for the Debian packages that they need. Bash only. If all
# packages are installed already, nothing is installed and no network is used.
. .ci/steps.sh

# CMakeLists.txt says the same; here it is said before anything is installed.
case "$PWD" in
  *[\(\)\&\'\#\$\;\,\"\*\?\<\>\|\`]*)
    mcor_die "VTK's build tools cannot work in a folder with a character like ( & ' # $ , in its path: $PWD" ;;
esac

mcor_is_installed() { # PACKAGE
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Plain VTK's and ParaView's development packages exclude each other on Debian, so a machine has one SDK. Prints the SDK
# to use: what was asked for, else what is installed, else the answer to a question, or plain VTK where nobody can
# answer.
mcor_choose_sdk() { # "" | vtk | paraview
  case "${1:-}" in
    vtk) mcor_is_installed python3-paraview &&
      mcor_die "ParaView's VTK is installed, which excludes plain VTK; remove python3-paraview or use --sdk paraview" ;;
    paraview) mcor_is_installed python3-vtk9 &&
      mcor_die "plain VTK is installed, which excludes ParaView's; remove python3-vtk9 or use --sdk vtk" ;;
    "") ;;
    *) mcor_die "--sdk is vtk or paraview, not '$1'" ;;
  esac
  if [ -n "${1:-}" ]; then echo "$1"
  elif mcor_is_installed paraview-dev; then echo paraview
  elif mcor_is_installed libvtk9-dev; then echo vtk
  else mcor_ask_sdk; fi
}

# Asks before anything is installed.
mcor_ask_sdk() {
  local answer=
  echo "No SDK is installed yet: paraview (the plugin, and ParaView itself) or vtk (program, Python and C++" >&2
  echo "without a plugin). On Debian they exclude each other." >&2
  if [ -t 0 ]; then
    read -r -p "Which one, vtk or paraview? [vtk] " answer
  else
    echo "Taking vtk; --sdk paraview takes the other." >&2
  fi
  case "${answer:-vtk}" in
    vtk | paraview) echo "${answer:-vtk}" ;;
    *) mcor_die "the SDK is vtk or paraview, not '$answer'" ;;
  esac
}

mcor_common_packages() {
  echo cmake ninja-build gcc g++ clang pkg-config python3 python3-numpy \
    ocl-icd-opencl-dev opencl-c-headers pocl-opencl-icd \
    xvfb xauth libgl1-mesa-dri
}

# The wheel's tests need python3-venv, and fetch the rest from PyPI. gdb shows the stacks of processes that stand still.
# Mesa's OpenCL on the CPU compiles as GPUs' drivers do. oclgrind simulates a device; only Debian 12's is known to work,
# so other systems leave its tests out.
mcor_test_packages() {
  echo libcmocka-dev mesa-opencl-icd python3-venv mpi-default-bin gdb
  if [ "$(. /etc/os-release && echo "${VERSION_ID:-0}")" -eq 12 ]; then echo oclgrind; fi
}

mcor_sdk_packages() { # vtk | paraview
  if [ "$1" = vtk ]; then
    echo libvtk9-dev python3-vtk9
    return
  fi
  # ParaView's CMake files look for every library that ParaView was built with.
  echo paraview-dev python3-paraview \
    libhdf5-mpi-dev libutfcpp-dev libexpat1-dev libdouble-conversion-dev libeigen3-dev libfreetype-dev \
    libgl2ps-dev libglew-dev libjpeg-dev libjsoncpp-dev libxml2-dev liblz4-dev liblzma-dev libnetcdf-dev \
    libogg-dev libpng-dev libpugixml-dev libproj-dev libsqlite3-dev libtheora-dev libtiff-dev zlib1g-dev \
    libprotobuf-dev protobuf-compiler libpython3-dev libcgns-dev libboost-dev libgdal-dev libavcodec-dev \
    libavformat-dev libavutil-dev libswscale-dev nlohmann-json3-dev libfmt-dev libx11-dev libxt-dev \
    mpi-default-dev
  if [ "$(. /etc/os-release && echo "${VERSION_ID:-0}")" -ge 13 ]; then
    echo qt6-base-dev qt6-tools-dev qt6-svg-dev qt6-5compat-dev qt6-documentation-tools libxkbcommon-dev
  else
    echo qtbase5-dev qttools5-dev libqt5svg5-dev libqt5opengl5-dev libqt5x11extras5-dev \
      qtxmlpatterns5-dev-tools
  fi
}

# Prints the sizes that apt tells.
mcor_sizes() { # PACKAGE...
  LC_ALL=C apt-get install --assume-no --no-install-recommends "$@" 2>/dev/null |
    sed -n -E 's/^ *(Need to get.*|After this operation.*)$/  \1/p'
}

# Runs as root.
mcor_apt_install() { # PACKAGE...
  export DEBIAN_FRONTEND=noninteractive
  mcor_step "Reading the lists of packages" apt-get update -q || return
  mcor_sizes "$@"
  mcor_step "Downloading packages" \
    apt-get install -q -y --no-install-recommends --download-only "$@" || return
  mcor_step must-finish "Unpacking packages" \
    apt-get install -q -y --no-install-recommends "$@"
}

# Runs a function of this file as root.
mcor_as_root() { # FUNCTION ARGUMENTS...
  local sudo=()
  if [ "$(id -u)" -ne 0 ]; then sudo=(sudo); fi
  "${sudo[@]}" bash -c '. .ci/packages.sh && "$@"' "$(basename "$0")" "$@"
}

mcor_install() { # PACKAGE...
  local package missing=() status=0
  command -v dpkg-query >/dev/null ||
    mcor_die "this is not a Debian system; CONTRIBUTING.md lists what to install by hand"
  for package in "$@"; do
    mcor_is_installed "$package" || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  [ "$(id -u)" -eq 0 ] || command -v sudo >/dev/null ||
    mcor_die "needs root or sudo to install: ${missing[*]}"
  echo "Installing ${#missing[@]} packages and what they need: ${missing[*]}"
  mcor_as_root mcor_apt_install "${missing[@]}" || status=$?
  [ "$status" -ne 130 ] || exit 130
  [ "$status" -eq 0 ] || mcor_die "the packages could not be installed"
}

# Debian 13's ParaView SDK lacks files that its CMake files name.
mcor_mend_sdk() { # vtk | paraview
  [ "$1" = paraview ] && .ci/mend-paraview-sdk --needed || return 0
  echo "Debian's ParaView SDK is packaged with files missing: making links in their place (.ci/mend-paraview-sdk)"
  mcor_as_root .ci/mend-paraview-sdk
}
