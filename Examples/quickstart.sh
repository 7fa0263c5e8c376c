#!/usr/bin/env bash
# Installs what is needed (Debian 12 or 13; root, or a user with sudo), builds, and extracts two
# surfaces from the dam break in Examples/Data: an isosurface of the speed, and the free surface.
#
#   ./Examples/quickstart.sh [--sdk vtk|paraview]
#
# --sdk chooses on a machine that has neither: paraview builds the plugin, too, vtk does without ParaView.
# Without --sdk you are asked; where nobody can answer it is vtk. Results: build/quickstart/.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
. .ci/packages.sh

sdk=
while [ $# -gt 0 ]; do
  case "$1" in
    --sdk) sdk=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$sdk" ] || mcor_die "--sdk is vtk or paraview" ;;
    -h | --help) mcor_help; exit 0 ;;
    *) mcor_die "unknown option $1 (see --help)" ;;
  esac
done

sdk=$(mcor_choose_sdk "$sdk")
# shellcheck disable=SC2046  # the functions print lists of words
mcor_install $(mcor_common_packages) $(mcor_sdk_packages "$sdk")
mcor_mend_sdk "$sdk"
mcor_build build "$sdk" -DMCOR_BUILD_TESTING=OFF

out=build/quickstart
mkdir -p "$out"
extract() { # NAME OPTIONS...
  local name=$1
  shift
  set -- build/bin/marching-correctors Examples/Data/dam_break_45k.vtp "$out/$name.vtp" "$@" \
    --fluid ParticleType=0 --screenshot "$out/$name.png" --stats "$out/$name.json"
  printf '\n== %s\n' "$*"
  Testing/with-display.sh "$@"
}
extract speed --scalar Velocity --component magnitude --iso 1.0
extract free_surface --free-surface

echo
echo "Surfaces, pictures and statistics:"
du -a --apparent-size -B 1000 "$out"/* | awk '{ printf "%8d kB  %s\n", $1, $2 }'
cat <<EOF

Next, in this folder, with your own data:

    export PATH="$PWD/build/bin:\$PATH"
    marching-correctors --list-arrays YOUR_FILE
    marching-correctors YOUR_FILE surface.vtp --free-surface

Documentation/Guide/i-want.md has more commands, Documentation/Guide/your-data.md those of each solver.
EOF
