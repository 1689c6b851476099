# The templates of `lockstep new-plugin` as texts inside the program: framework/tools/program/templates/<kind>/<file>. They are
# whole plugins, and the tests build and run them as they stand.
file(GLOB_RECURSE template_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/framework/tools/program/templates/*)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${template_files})
set(template_texts "")
foreach(template_file IN LISTS template_files)
  file(READ ${template_file} text)
  cmake_path(GET template_file FILENAME name)
  cmake_path(GET template_file PARENT_PATH folder)
  cmake_path(GET folder FILENAME kind)
  string(APPEND template_texts "    {\"${kind}\", \"${name}\", R\"lockstep(${text})lockstep\"},\n")
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
