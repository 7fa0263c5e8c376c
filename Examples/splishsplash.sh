#!/usr/bin/env bash
# From the files of a run of SPlisHSPlasH to meshes for Blender with velocities, the water level over time with a plot, and a flux.
#
#   Examples/splishsplash.sh OUT_FOLDER RADIUS [ParticleData_Fluid_*.vtk]
#
# RADIUS: the scene's particleRadius; the smoothing length is twice as long. Without files, sample ones of the same form
# are made (RADIUS is then 0.0133, and z is up). Build first: Examples/quickstart.sh. The plot needs matplotlib, in python3 or $PYTHON.
set -euo pipefail
[ $# -ge 2 ] || { awk 'NR > 1 { if (!/^#/) exit; sub(/^# ?/, ""); print }' "$0"; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
export PATH="$PATH:$here/../build/bin"
out=$1 h=$(awk -v r="$2" 'BEGIN { print 2 * r }')
shift 2
mkdir -p "$out"
if [ $# -eq 0 ]; then
  /usr/bin/python3 "$here/Data/make_particles.py" splash 20000 "$out/ParticleData_Fluid_%d.vtk" --steps 6
  set -- "$out"/ParticleData_Fluid_*.vtk
fi

# The exporter stores positions and velocities; its times are the frames' numbers times the interval.
particles=(--smoothing-length "$h" --time-step 0.02)
marching-correctors "$@" "$out/film_%04d.ply" --free-surface --smooth "${particles[@]}"
marching-correctors "$@" "$out/level.csv" "${particles[@]}" --gauge mast=0.5,0,-0.2:0.5,0,0.5
marching-correctors "$@" "$out/flux.csv" "${particles[@]}" --density 1000 --flux gate=disc:0.4,0,0:1,0,0:0.2
"${PYTHON:-python3}" "$here/plot_table.py" "$out/level.csv" last "$out/level.png"
echo "$out: film_0000.ply, ... for Blender; level.csv, flux.csv; level.png"
