#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pictures.sh SOURCE BUILD_TREE OUT [NAME...]: draws the pictures of the pages into the folder OUT, all or those that are
# named, as NAME.webp; the name "catalogue" is that of all pictures of catalogue.md, catalogue/TYPE.webp. Each is the report
# of a scene in a browser, without the panels of the report; laws are curves. The scene is a file of SOURCE, or a block
# ```json SCENE.json of the page. 77: there is no browser, no ImageMagick or no gnuplot here.
set -euo pipefail
source="$1" build="$2" out="$3" wanted=" ${*:4} "
browser="$(command -v chromium || command -v chromium-browser || true)"
[ -n "$browser" ] || { echo "skipped: there is no chromium"; exit 77; }
command -v convert >/dev/null || { echo "skipped: there is no convert (ImageMagick)"; exit 77; }
export LOCKSTEP_PLUGIN_PATH="$build/plugins"
work="$(mktemp -d)"
mkdir -p "$out"
trap 'rm -rf "$work"' EXIT
is_wanted() { [[ -z "${wanted// /}" || "$wanted" == *" $1 "* ]]; }
quietly() { "$@" >"$work/words.txt" 2>&1 || { cat "$work/words.txt"; exit 1; }; }

# lockstep COMMAND PAGE SCENE NAME WORDS...: NAME.html, by the command report or sweep.
lockstep() {
  local file="$source/$3"
  if [ ! -e "$file" ]; then
    file="$work/$3"
    awk -v head="\`\`\`json $3" '/^```$/ { on = 0 } on; $0 == head { on = 1 }' "$source/$2" >"$file"
  fi
  quietly "$build/bin/lockstep" "$1" "$file" --quiet --record "$work/$4.csv" "${@:5}" "$work/$4.html"
}

# shot NAME WIDTHxHEIGHT SCRIPT: NAME.png, twice as large, of NAME.html after lines of JavaScript, for which `page` is the
# report (lockstepReport of framework/tools/report/web/src/run.js).
style='header, footer, aside, .time, .choices, .note, .points-row, details { display: none !important }
main { display: block } .left { border: 0 } .stage { flex: none; height: 100vh } .label { font-size: 14px }'
shot() {
  printf '<style>%s</style><script type="module">const page = lockstepReport; %s</script>\n' "$style" "$3" >>"$work/$1.html"
  quietly timeout 300 "$browser" --headless --no-sandbox --hide-scrollbars --force-device-scale-factor=2 \
    --window-size="${2/x/,}" --virtual-time-budget=8000 --user-data-dir="$work/browser" \
    --screenshot="$work/$1.png" "file://$work/$1.html"
}
save() { convert "$work/$1.png" -resize 50% -quality 82 "$out/$1.webp"; }

# picture NAME PAGE SCENE TIME WIDTHxHEIGHT SCRIPT: the mechanism at a time.
picture() {
  is_wanted "$1" || return 0
  lockstep report "$2" "$3" "$1" --out
  shot "$1" "$5" "page.clock.pause(); page.clock.seek($4); $6" && save "$1"
}

# points NAME PAGE SCENE VARY WIDTHxHEIGHT COLUMN: a column of a sweep.
points() {
  is_wanted "$1" || return 0
  lockstep sweep "$2" "$3" "$1" --vary "$4" --report
  shot "$1" "$5" "const { points } = page; points.joined = true;
    points.choose('y', String(points.table.columns.findIndex((c) => c.title.startsWith('$6'))));" && save "$1"
}

# film NAME PAGE SCENE PERIOD WIDTHxHEIGHT SCRIPT: the mechanism in motion, in 48 frames from a sheet of 8 by 6.
film() {
  is_wanted "$1" || return 0
  lockstep report "$2" "$3" "$1" --out
  shot "$1" "$((8 * ${5%x*}))x$((6 * ${5#*x}))" "page.clock.pause(); $6
    Object.assign(page.elements.stage.style, { width: '${5%x*}px', height: '${5#*x}px' }); page.stage.resize();
    const frames = [...Array(48).keys()].map((k) => {
      page.clock.seek((k * $4) / 48);
      return Object.assign(new Image(${5/x/,}), { src: page.stage.picture() });
    });
    document.body.style.flexFlow = 'row wrap'; document.body.replaceChildren(...frames);"
  convert "$work/$1.png" -resize 50% -crop "$5" +repage "$work/$1_%02d.png"
  convert -delay 4 -loop 0 "$work/$1"_??.png -quality 60 "$out/$1.webp"
}

# The catalogue. entry NAME SYMBOL TIME GHOSTS VIEW ZOOM [SCRIPT]: catalogue/NAME.webp of the page's catalogue_NAME.json at
# a time, with symbols of a size in m; z is up. GHOSTS: times at which the bodies are drawn pale; VIEW: "x, y, z" of the
# direction to the viewer; ZOOM: how much larger than as large as fits.
entry() {
  is_wanted catalogue || is_wanted "$1" || return 0
  lockstep report framework/docs/catalogue.md "catalogue_$1.json" "$1" --out
  printf '<style>.scales { display: none } .axes { transform: scale(0.7); transform-origin: bottom left }</style><script>
    const data = document.getElementById("data"), json = JSON.parse(data.textContent);
    json.mechanism.length = (2 * %s) / 0.024;  // the unit of symbols follows from it
    data.textContent = JSON.stringify(json);</script>\n' "$2" >>"$work/$1.html"
  shot "$1" 360x240 "
    const { stage, world } = page, { views } = stage, { frame, arrows } = world;
    page.clock.pause(); page.names(); arrows.factor = 0.6;
    for (const part of world.joints.symbols.flat()) if (part.isLineSegments) part.removeFromParent();  // hatched ground
    const points = [], put = (p, x, y, z) => points.push(p.clone().add(frame.up.clone().set(x, y, z)));
    for (const t of [$4${4:+,} $3]) {
      world.pose(t);
      for (const p of world.keyPoints()) put(p, 0, 0, 0);
      for (const marker of world.markers) for (const z of [-2, 2]) put(marker.getWorldPosition(frame.up.clone()), 0, 0, z * $2);
      if (t !== $3) for (const body of world.bodies.moving) {
        const ghost = body.clone(true);
        ghost.traverse((part) => {
          const look = { transparent: true, opacity: 0.2, depthWrite: false };
          if (part.material) part.material = Object.assign(part.material.clone(), look);
        });
        world.root.add(ghost);
      }
    }
    page.clock.seek($3); page.tools.show(); world.root.updateMatrixWorld(true);
    for (const { force, moment } of arrows.items) {
      if (force.visible) put(force.head.getWorldPosition(frame.up.clone()), 0, 0, 0);
      if (moment.visible) for (const r of [-1.1, 1.1]) for (const k of [0, 1]) put(moment.position, k * r * moment.scale.x, (1 - k) * r * moment.scale.x, 0);
    }
    frame.up.set(0, 0, 1);
    frame.points = points;
    views.use(false); views.resize(1.5);
    views.direction = frame.up.clone().set($5);
    page.fit();
    for (let i = 0; i < 4; ++i) {  // the points in the middle, and as large as they fit
      views.camera.updateMatrixWorld();
      const seen = points.map((p) => p.clone().project(views.camera));
      const [[left, right], [low, high]] = ['x', 'y'].map((k) => [Math.min(...seen.map((p) => p[k])), Math.max(...seen.map((p) => p[k]))]);
      views.pan((left + right) * 0.375, (low + high) * 0.25);
      page.zoom(1.75 / Math.max(right - left, high - low));
    }
    page.zoom($6); ${7:-}"
  mkdir -p "$out/catalogue"
  convert "$work/$1.png" -resize 50% -quality 80 "$out/catalogue/$1.webp"
}

# curve NAME [WORD] [POINTS]: catalogue/NAME.webp, the first recorded column of the page's catalogue_NAME.json against the
# time; WORD "acceleration": also the third one, to another scale. POINTS: "t,y" each, divided by semicolons.
curve() {
  is_wanted catalogue || is_wanted "$1" || return 0
  command -v gnuplot >/dev/null || { echo "skipped: there is no gnuplot"; exit 77; }
  lockstep report framework/docs/catalogue.md "catalogue_$1.json" "$1" --out
  printf '%s\n' "${3:-}" | tr ';' '\n' >"$work/$1.txt"
  {
    printf 'set terminal pngcairo size 720,480 background "#f7f8fa" font "DejaVu Sans,20"; set output "%s"; set datafile separator ","\n' "$work/$1.png"
    echo 'set border 3 lc "#5a6573"; set tics nomirror textcolor "#1c2530"; set xlabel "t [s]" offset 0,0.5; set grid lc "#e3e7ec" lt 1'
    echo 'set ylabel "y"; set format y "%g"; set autoscale xfix; set offsets 0,0,graph 0.05,graph 0.05; set key outside top center horizontal samplen 2 width -4'
    printf 'stats "%s" skip 1 using 2 name "y" nooutput; if (y_min == y_max) set yrange [0:2*y_max]\n' "$work/$1.csv"
    if [ "${2:-}" = acceleration ]; then
      printf 'stats "%s" skip 1 using 4 name "a" nooutput; set y2range [-1.4*a_max:1.4*a_max]\n' "$work/$1.csv"
      printf 'plot "%s" skip 1 using 1:4 axes x1y2 with lines lw 3 dt (8,6) lc "#d55e00" title "acceleration", ' "$work/$1.csv"
      printf '"" skip 1 using 1:2 with lines lw 5 lc "#0072b2" title "y"\n'
    else
      printf 'plot "%s" skip 1 using 1:2 with lines lw 5 lc "#0072b2" notitle' "$work/$1.csv"
      [ -z "${3:-}" ] || printf ', "%s" using 1:2 with points pt 7 ps 2 lc "#d55e00" notitle' "$work/$1.txt"
      echo
    fi
  } | quietly gnuplot
  mkdir -p "$out/catalogue"
  convert "$work/$1.png" -resize 50% -quality 80 "$out/catalogue/$1.webp"
}

film four_bar README.md samples/scenes/four_bar.json 0.6283185307 480x340 'page.look("iso"); page.elements.reactions.click();'
page=framework/docs/first_steps.md named='page.elements.joints.click(); page.look("iso");'
picture first_steps_1 $page rod.json 0.1 640x320 'page.look("iso");'
picture first_steps_2 $page swing.json 0.08 640x360 "$named"
picture first_steps_3 $page open.json 0.12 640x400 "$named"
picture first_steps_4 $page closed.json 0.45 640x400 "$named"
picture first_steps_5 $page four_bar.json 0.06 640x400 "$named"
picture first_steps_6 $page four_bar.json 0.01 640x400 "$named page.names(); page.elements.reactions.click(); page.world.arrows.factor = 1.6; page.tools.show();"
points first_steps_7 $page four_bar.json 'crank=60mm:120mm:13' 640x340 'torque min'

entry angular_alignment 0.035 0.4 '0, 0.13, 0.26' '0.3, -1, 0.35' 1
entry cylindrical 0.04 0.5 '0, 0.25' '0.5, -1, 0.45' 1
entry distance 0.035 0.76 '0, 0.3, 0.45' '0.3, -1, 0.2' 1
entry fixed 0.045 0.05 '0.3, 0.6' '0.6, -1, 0.5' 1
entry function 0.04 0.2 '0, 0.1' '1, -1, 0.4' 1
entry homokinetic 0.065 0.2 '' '0.2, -1, 0.25' 1
entry lock 0.04 0.5 '0, 0.25' '0.5, -1, 0.5' 0.9
entry oldham 0.04 0.3 '' '0.3, -1, 0.5' 1
entry path_follower 0.035 1.0 '0, 0.55, 0.8' '0.5, -1, 0.55' 1
entry plane_on_plane 0.04 0.5 '0, 0.25' '0.3, -1, 0.8' 1
entry point_on_curve 0.03 0.5 '0, 0.3' '0.2, -1, 0.2' 1
entry point_on_line 0.04 0.5 '0, 0.25' '0.4, -1, 0.35' 1
entry point_on_plane 0.035 0.25 '0, 0.12' '0.3, -1, 0.5' 1
entry prismatic 0.04 0.5 '0, 0.25' '0.5, -1, 0.4' 1
entry revolute 0.05 0.6 '0, 0.3' '0.5, -1, 0.6' 1
entry rzeppa 0.045 0.2 '' '0.2, -1, 0.25' 1
entry screw 0.045 1.0 '0, 0.5' '0.5, -1, 0.4' 0.93
entry spherical 0.045 0.12 '0.5, 0.7, 0.3' '0.4, -1, 0.2' 1
entry stop 0.045 0.35 '0, 0.18' '0.3, -1, 0.8' 1
entry universal 0.05 0.2 '' '0.2, -1, 0.25' 1
entry belt 0.035 0.5 '' '0.2, -1, 1' 1
entry cam_flat 0.03 0.5 '' '0.2, -1, 1.2' 1
entry cam_roller 0.03 0.5 '' '0.2, -1, 1.2' 1
entry differential 0.04 0.35 '' '0.4, -1, 0.7' 1
entry gear 0.035 0.5 '' '0.2, -1, 1' 1
entry rack_and_pinion 0.035 0.5 '0' '0.3, -1, 0.9' 1
entry applied_force 0.045 0.3 '0' '0.5, -1, 0.6' 1
entry applied_torque 0.045 0.3 '0' '0.5, -1, 0.6' 1
entry bushing 0.028 0.26 '0' '0.3, -1, 0.2' 1
entry force_motor 0.035 0.34 '0' '0.5, -1, 0.4' 1
entry function_force 0.035 0.24 '0' '0.3, -1, 0.5' 0.9
entry joint_friction 0.035 0.38 '0' '0.1, -1, 0.3' 1
entry spring_damper 0.03 0.24 '0' '0.4, -1, 0.25' 1
entry torque_motor 0.045 0.5 '0' '0.5, -1, 0.6' 1
entry torsion_spring_damper 0.045 0.2 '0' '0.5, -1, 0.6' 1
curve constant
curve cycloid acceleration
curve formula
curve fourier
curve harmonic_rise acceleration
curve poly345 acceleration
curve polynomial
curve product
curve ramp
curve repeat
curve scale
curve sequence
curve shift
curve sine
curve spline '' '0,0.02;0.4,0.1;0.9,0.05;1.4,0.08;2,0.03'
curve sum
curve trapezoid acceleration
entry along 0.03 0.5 '0, 0.2' '0.2, -1, 0.4' 1
entry axis_rotation 0.03 0.45 '0, 0.15' '0.4, -1, 0.7' 1
entry components 0.03 1.2 '0.15, 0.5, 0.85' '0.4, -1, 0.5' 1
entry constant_rotation 0.03 0.05 '0.3, 0.6' '0.6, -1, 0.5' 1
entry constant_translation 0.03 0.05 '0.3, 0.6' '0.6, -1, 0.5' 1
entry path 0.03 1 '0, 0.3, 0.6' '0.2, -1, 0.3' 1
entry product_rotation 0.03 0.6 '0, 0.3' '0.4, -1, 0.6' 1
entry spline_rotation 0.03 1 '0, 0.5' '0.4, -1, 0.6' 1
