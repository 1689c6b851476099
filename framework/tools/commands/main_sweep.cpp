// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-sweep: a scene run many times.
#include "framework/tools/commands/tool_verbs.h"

namespace lockstep {
namespace {

constexpr const char* kSweepFooter =
    R"(NAME is a parameter of the scene, or a path into it: bodies.arm.mass, links.A.drive.law.slope, gravity.1, run.tolerance; an item of a
list is given by its name or by its number, counted from 0. Units are those of scenes: bodies.arm.mass=200g:1kg:5.
Several --vary make the full grid. Each run is one row: its number, the values, final, min and max of each recorded
column, the verdict on its energy with the imbalance, its largest violation, steps, CPU seconds, status. A run that
fails is a row with its reason, and the exit code is 1; 9 where a run did not conserve energy or drifted. In lanes the
energy is not judged where a law may move a link (--lanes off). Ctrl-C keeps the rows so far; --resume goes on.

Example:
  lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --vary gravity.1=-9.81,-1.62 --record moon.csv
Runs are shared out to all processors that the program may use (--jobs); shards share them out to several machines.
With GNU parallel, eight shards (units without blanks):
  parallel lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --quiet --shard {}/8 --record mass_{}.csv ::: $(seq 8)
Under Slurm, sbatch of a script with these lines:
  #SBATCH --array=1-8
  i=$SLURM_ARRAY_TASK_ID n=$SLURM_ARRAY_TASK_COUNT
  lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --quiet --shard $i/$n --record mass_$i.csv
The shares have one header. One table in the order of the whole grid is made by
  awk 'FNR > 1 || NR == 1' mass_*.csv | sort -t , -k 1,1n > mass.csv)";

std::vector<Command> commands() {
  return {
      {"sweep", "", "",
       join(
           {settings_options(),
            {Option{"--vary", "NAME=...", "NAME=a:b:n, n values evenly from a to b, or NAME=v1,v2,...; may be repeated"}
                 .needed()
                 .repeated(),
             {"--shard", "i/n", "only every n-th run, from the i-th on; i counts from 1"},
             {"--record", "FILE.csv",
              "the CSV file; default: <scene>_sweep.csv or <scene>_sweep_<i>of<n>.csv, in LOCKSTEP_OUTPUT or here; "
              "-: standard output, and words to standard error"},
             {"--report", "FILE.html",
              "one HTML file that shows each run as a point, by any two columns; with --histories a click shows its "
              "curves and its motion"},
             Option{"--lanes", "MODE", "auto: eight runs at once if the mechanism is suited; off: one by one"}.among(
                 "auto,off"),
             {"--jobs", "N",
              "threads that compute runs, 1 to 1024; default: the processors that the program may use, 1 with "
              "--shard. Laws, links and forces of plugins that share data among runs need --jobs 1"},
             {"--histories", "DIR", "folder for the columns of each run, <its number>.csv"},
             kHeaders,
             {"--quiet", "", "print errors only"},
             kJson.without("--quiet"),
             Option{"--resume", "",
                    "go on where the same sweep was interrupted or killed: the rows that are there stay"}
                 .without("--json")}}),
       sweep_command, kSweepFooter}};
}

}  // namespace
}  // namespace lockstep

int main(int argc, char* argv[]) { return lockstep::run_program(lockstep::commands, false, argc, argv); }
