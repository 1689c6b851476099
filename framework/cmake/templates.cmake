# SPDX-License-Identifier: BSD-3-Clause
# The templates of `lockstep new-plugin` as texts inside the program: framework/tools/program/templates/<kind>/<file>, and
# those of common/ for every kind, with @kind@ replaced. The tests build and run the sources as they stand.
set(template_folder ${PROJECT_SOURCE_DIR}/framework/tools/program/templates)
set(template_texts "")
function(add_template kind file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(REPLACE "@kind@" "${kind}" text "${text}")
  cmake_path(GET file FILENAME name)
  string(APPEND template_texts "    {\"${kind}\", \"${name}\", R\"lockstep(${text})lockstep\"},\n")
  set(template_texts "${template_texts}" PARENT_SCOPE)
endfunction()
foreach(kind joint coupling law force integrator)
  file(GLOB template_files CONFIGURE_DEPENDS ${template_folder}/${kind}/* ${template_folder}/common/*)
  foreach(template_file IN LISTS template_files)
    add_template(${kind} ${template_file})
  endforeach()
endforeach()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/framework/tools/program/template_files.cpp @ONLY CONTENT
"// Written by the configuration from framework/tools/program/templates.
#include \"framework/tools/program/new_plugin.h\"

namespace lockstep {

std::span<const TemplateFile> template_files() {
  static constexpr TemplateFile files[] = {
${template_texts}  };
  return files;
}

}  // namespace lockstep
")

# The scene of `lockstep demo`, which so needs no installed file.
set(demo_file ${PROJECT_SOURCE_DIR}/samples/scenes/four_bar.json)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${demo_file})
file(READ ${demo_file} demo_text)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/framework/tools/program/demo_scene.cpp @ONLY CONTENT
"// Written by the configuration from samples/scenes/four_bar.json.
#include \"framework/tools/program/demo.h\"

namespace lockstep {

std::string_view demo_scene() {
  return R\"lockstep(${demo_text})lockstep\";
}

}  // namespace lockstep
")
