// SPDX-License-Identifier: BSD-3-Clause
// The files of a run: their names, and whether they can be written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include "framework/description/scene/reading.h"

namespace lockstep {

class Arguments;

/// All of standard input, up to one byte more than the longest scene, which reading then rejects.
std::string standard_input();

/// A word as a shell reads it: in quotes if it needs them.
std::string in_quotes(const std::string& word);

/// LOCKSTEP_OUTPUT, or "." if it is not set: the folder of results without a name.
std::string output_folder();

/// A folder below share/ of the installation that this program belongs to, such as "lockstep/scenes"; "" if there is
/// none.
std::string shared_folder(const std::string& name);
/// The file of a scene. "samples/scenes/x.json" is that of the installation if there is no such file. Throws FileError,
/// which names the folder of the samples, for a scene that does not exist in an installation.
std::string scene_or_sample(const std::string& named);

/// The name of a scene's file without folder and ending; "stdin" for standard input.
std::string stem_of(const std::string& scene);

/// Creates a folder and those above it. Throws FileError, whose words end with the next move.
void make_folder(const std::string& folder, const std::string& next = "name another");

/// The CSV file: `record` if given, else <scene>.csv in LOCKSTEP_OUTPUT or the current folder. Makes its folder. Throws
/// FileError.
std::string csv_path(const std::string& record, const std::string& scene);

/// That of a command with the options --record and scene. Throws UsageError for a channel of the system in place of a
/// file, "A.force_on_p_world_x".
std::string csv_path(const Arguments&, const System&);

/// Throws FileError if the file cannot be written; called before the run, so that no result is lost.
void check_writable(const std::string& file);

/// The base, without ending, of a picture of one column against another: "four_bar.By_over_Bx" next to four_bar.csv.
std::string picture_base(const std::string& csv, const PictureRequest&);

/// Throws UsageError if the results, or their pictures, would replace a file that the scene is read from: its own, or
/// one that it names.
void check_overwrites(const std::string& csv, const Scene&, const std::vector<PictureRequest>& pictures = {});
/// The same of a checkpoint, which must not be the CSV file of its run either.
void check_checkpoint(const std::string& checkpoint, const std::string& csv, const Scene&);

/// A hash of all files that a scene is read from.
std::uint64_t hash_of_files(const Scene&);
/// A hash of the files of the plugins that a scene, or the command line, requires.
std::uint64_t hash_of_plugins(const Scene&, const std::vector<std::string>& plugins);

/// The HTML file of a report, whose folder it makes. Throws FileError, and UsageError if the name is that of another
/// result, or of a file that the scene is read from.
std::string report_path(const std::string& report, const std::string& csv, const Scene&);

/// Shows a file in the browser, as far as this machine can (xdg-open). Returns why not, or "".
std::string open_in_browser(const std::string& file);

/// Throws UsageError if the scene reads a file that is not in its folder or below: a scene may come from others, and
/// must not reveal other files. Links are followed.
void check_files(const Scene&);
/// The same of one file: `value` names it by the text `written`, and it is at `path`; the scene's own path is `scene`.
void check_file(const std::string& scene, const Value& value, const std::string& path, const std::string& written);

}  // namespace lockstep
