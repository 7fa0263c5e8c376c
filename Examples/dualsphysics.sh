#!/usr/bin/env bash
# From the files of a run of DualSPHysics to a film, the front of the water over time with a plot, and what flows outwards.
#
#   Examples/dualsphysics.sh OUT_FOLDER DP [PartFluid_*.vtk]
#
# DP: the initial particle distance of the case. Without files, sample ones of the same form are made (DP is then 0.0266). Build
# first: Examples/quickstart.sh. The plot needs matplotlib, in python3 or $PYTHON.
set -euo pipefail
[ $# -ge 2 ] || { awk 'NR > 1 { if (!/^#/) exit; sub(/^# ?/, ""); print }' "$0"; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
export PATH="$PATH:$here/../build/bin"
out=$1 dp=$2
shift 2
mkdir -p "$out"
if [ $# -eq 0 ]; then
  /usr/bin/python3 "$here/Data/make_particles.py" splash 20000 "$out/PartFluid_%04d.vtk" --steps 6
  set -- "$out"/PartFluid_*.vtk
fi

# PartVTK leaves out smoothing lengths: h is coefh x sqrt(3) x dp, and coefh 1 here. Volumes follow from the positions, so that drops keep
# their surface.
particles=(--dp "$dp" --coefh 1 --volume computed --kernel wendland)
marching-correctors "$@" "$out/film.pvd" --free-surface --smooth "${particles[@]}" --components "$out/pieces.csv"
marching-correctors "$@" "$out/front.csv" "${particles[@]}" --gauge floor=0,0,0.1:1,0,0.1
marching-correctors "$@" "$out/flux.csv" "${particles[@]}" --density 1000 --flux outwards=box:-0.4,0.4,-0.4,0.4,-0.3,0.5
"${PYTHON:-python3}" "$here/plot_table.py" "$out/front.csv" last "$out/front.png"
echo "$out: film.pvd for ParaView; pieces.csv, front.csv, flux.csv; front.png"
