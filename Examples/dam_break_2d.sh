#!/usr/bin/env bash
# From the steps of a two-dimensional run (PySPH, SPHinXsys, DualSPHysics 2-D) to a film of its free surface and of bands of pressure,
# the water level over time with a plot, and what flows through a line.
#
#   Examples/dam_break_2d.sh OUT_FOLDER [FILE...]
#
# Without files, a wave in a flume is made. Files of PySPH: first python -m marchingcorrectors convert. Build first:
# Examples/quickstart.sh. The plot needs matplotlib, in python3 or $PYTHON.
set -euo pipefail
[ $# -ge 1 ] || { awk 'NR > 1 { if (!/^#/) exit; sub(/^# ?/, ""); print }' "$0"; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
export PATH="$PATH:$here/../build/bin"
out=$1
shift
mkdir -p "$out"
if [ $# -eq 0 ]; then
  /usr/bin/python3 "$here/Data/make_particles.py" wave 5000 "$out/flume_%04d.vtk" --steps 6
  set -- "$out"/flume_*.vtk
fi

fluid=(--fluid Type=0)
marching-correctors "$@" "$out/free_surface.pvd" --free-surface "${fluid[@]}"
marching-correctors "$@" "$out/bands.pvd" --scalar Pressure --iso=-1,1000,2000,3000 --filled "${fluid[@]}"
marching-correctors "$@" "$out/level.csv" "${fluid[@]}" --gauge mast=1.7,0,0:1.7,0,1
marching-correctors "$@" "$out/flux.csv" "${fluid[@]}" --flux gate=1.7,0,0:1.7,0,1
"${PYTHON:-python3}" "$here/plot_table.py" "$out/level.csv" last "$out/level.png"
echo "$out: free_surface.pvd and bands.pvd for ParaView; level.csv, flux.csv; level.png"
