#!/usr/bin/env bash
# Makes the pictures of these pages again: docs/make_pictures.sh build/bin/ricci ../shared/data [NAME...]
# With names, only those (kitten_domain, ...). Needs the sample meshes, rsvg-convert (librsvg2-bin), pngquant and, for the
# picture of the sweep, /usr/bin/python3 with numpy and h5py. Small SVG files stay SVG, the others become PNG.
set -euo pipefail
(($# >= 2)) || { echo "usage: docs/make_pictures.sh RICCI DATA [NAME...]" >&2; exit 2; }
ricci=$(readlink -f "$1")
data=$(readlink -f "$2")/meshes
shift 2
wanted=" $* "
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
out=$root/docs/pictures
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
largest_svg=60000  # bytes

# want NAME: whether that picture is to be made.
want() { [[ $wanted == "  " || $wanted == *" $1 "* ]]; }

# keep NAME [PIXELS [COLOURS]]: NAME.svg of the scratch folder into docs/pictures.
keep() {
    local name=$1 pixels=${2:-720} colours=${3:-64}
    rm -f "$out/$name".{svg,png}
    if (($(stat -c %s "$name.svg") <= largest_svg)); then
        cp "$name.svg" "$out/$name.svg"
    else
        rsvg-convert --background-color white --width "$pixels" "$name.svg" -o "$name.png"
        pngquant --force --speed 1 --strip --output "$out/$name.png" "$colours" "$name.png"
    fi
    ls -s --block-size=1 "$out/$name".*
}

# layout PIXELS NAME MESH OPTION...: a picture of `ricci layout`.
layout() {
    local pixels=$1 name=$2 mesh=$3
    shift 3
    want "$name" || return 0
    "$ricci" layout "$mesh" --svg "$name.svg" "$@" --quiet > "$name.txt"
    keep "$name" "$pixels"
}

# The kitten: a torus.
kitten=$data/closed_g1/kitten.obj
layout 420 kitten_surface "$kitten" --picture surface
layout 720 kitten_domain "$kitten" --picture domain
layout 480 kitten_tessellation "$kitten" --picture tessellation --copies 60

# Genus 2 in two models.
double=$data/closed_g2/double-torus.obj
layout 360 double_torus_surface "$double" --picture surface
layout 640 double_torus_domain "$double" --picture domain
layout 640 double_torus_tessellation "$double" --picture tessellation --copies 3000
layout 480 double_torus_klein "$double" --picture tessellation --copies 3000 --model klein
layout 360 double_torus_texture "$double" --picture texture
layout 640 flat_best "$double" --cone=4:-4pi --picture domain

# A tube, a face, a sphere, a chair with three boundaries.
colon=$data/tube_colon/ct_colon_segment_annulus.off
layout 640 colon_surface "$colon" --picture surface-curvature
layout 420 colon_strip "$colon" --picture curvature
layout 420 face_texture "$data/disk/face.obj" --picture texture --geometry euclidean --target boundary
layout 640 face_angles "$data/disk/face.obj" --picture angles --subdivide 1
layout 600 planck_sphere "$data/closed_g0/maxplanck.nf25k.off" --picture curvature
layout 600 chair_domain "$data/pants/BentChair.obj" --picture domain

# Every vertex as the only cone.
if want sweep_distortion; then
    "$ricci" sweep "$double" -o sweep.h5 --quiet > sweep.txt
    /usr/bin/python3 "$root/bench/distortion_picture.py" sweep.h5 --output sweep_distortion.svg
    keep sweep_distortion 900
fi

# Closed geodesics and coordinates.
if want geodesics; then
    "$ricci" spectrum "$double" --count 8 --draw 4 --svg geodesics.svg --quiet > geodesics.txt
    keep geodesics 360
fi
if want marking; then
    "$ricci" teichmuller "$double" --svg marking.svg --quiet > marking.txt
    keep marking 360
fi

# A deformation: the double torus stretched along x.
if want path; then
    mkdir -p stretch
    for k in 00 01 02 03 04 05 06 07 08 09 10; do
        awk -v s="1.$k" '$1 == "v" { printf "v %.9g %s %s\n", $2 * (1 + 5 * (s - 1)), $3, $4; next } 1' "$double" > "stretch/$k.obj"
    done
    "$ricci" path stretch/ -o path.csv --svg path.svg --quiet > path.txt
    keep path
fi

# Shapes by their conformal structure.
if want dendrogram; then
    mkdir -p shapes
    cp "$double" "$data"/pairs/g2_doubletorus/*.obj "$data"/pairs/g2_mac/*.obj "$data"/closed_g2/skull.obj \
        "$data"/closed_g2/doubletorus_60v.obj shapes/
    "$ricci" index build shapes/ -o shapes.h5 --quiet > index.txt
    "$ricci" index distances shapes.h5 -o distances.csv --dendrogram dendrogram.svg --quiet > distances.txt
    keep dendrogram
fi
