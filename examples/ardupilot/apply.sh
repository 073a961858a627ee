#!/bin/sh
# Puts fga into a tree of ArduPilot: sh apply.sh TREE PREFIX, where `cmake --install` has put the library into PREFIX.
# It copies four files and adds five lines; `git diff` in the tree shows them, `git checkout ArduPlane` takes them back.
set -eu
tree=$1 prefix=$2
here=$(dirname "$0")
plane=$tree/ArduPlane
scheduler=$(grep -l 'SCHED_TASK(avoidance_adsb_update' "$plane"/*.cpp)
cp "$here/fga_plane.h" "$here/fga_plane.cpp" "$prefix/include/fga.h" "$prefix/include/fga_task.h" "$plane/"

# add FILE TEXT LINE: LINE after the first line that contains TEXT; nothing where it is there already.
add() {
  grep -qF "$3" "$1" && return
  grep -qF "$2" "$1" || { echo "$1 has no \"$2\": add \"$3\" by hand" >&2; exit 1; }
  awk -v text="$2" -v line="$3" '{ print } !done && index($0, text) { print line; done = 1 }' "$1" > "$1.new"
  mv "$1.new" "$1"
}
add "$plane/Plane.h" 'friend class AP_Avoidance_Plane;' '    friend class FgaPlane;'
add "$plane/Parameters.h" '#pragma once' '#include "fga_plane.h"'
add "$plane/Parameters.h" 'ParametersG2(void);' '    FgaPlane fga;'
add "$plane/Parameters.cpp" 'ParametersG2::var_info[] = {' '    AP_SUBGROUPINFO(fga, "FGA_", 60, ParametersG2, FgaPlane),'
add "$scheduler" 'SCHED_TASK(avoidance_adsb_update' \
  '    SCHED_TASK_CLASS(FgaPlane, &plane.g2.fga, update, 10, 5000, 145), SCHED_TASK_CLASS(FgaPlane, &plane.g2.fga, watch, 50, 50, 146),'
