# SPDX-License-Identifier: BSD-3-Clause
# The templates of `lockstep new-plugin` as texts inside the program: framework/tools/program/templates/<kind>/<file>, and
# those of common/ for every kind, with @kind@ replaced. The tests build and run the sources as they stand. The test of each
# kind is test_template.cpp.in with what it checks, in words and in code.
set(template_folder ${PROJECT_SOURCE_DIR}/framework/tools/program/templates)
set(template_texts "")
set(joint_says "Checks Jacobian, rates, right-hand side and stiffness of the joint against differences.")
set(joint_check [[  const CheckReport report = check_lock(registry, "template_joint", {{"height", 0.1}, {"length", 0.7}});]])
set(coupling_says "Checks Jacobian, rates, right-hand side and stiffness of the coupling against differences.")
set(coupling_check [[  const CheckReport report = check_lock(registry, "template_coupling", {{"depth", 0.3}}, {.pairs = 2});]])
set(law_says "Checks the law's derivatives against differences, and that its breakpoints list all jumps.")
set(law_check [[
  const auto law = registry.laws.make("template_law", {{"rise", 0.3}, {"time", 0.2}, {"start", 0.5}}, &registry, "law");
  const CheckReport report = check_law(*law, {.from = 0, .to = 2}, "template_law");]])
set(force_says "Checks the force against its energies and, if it has a tangent, that against differences.")
set(force_check [[  const CheckReport report = check_force(registry, "template_force", {{"strength", 0.4}});]])
set(integrator_says "Measures the order of the integrator and checks what a run requires.")
set(integrator_check [[  const CheckReport report = check_integrator(registry, "template_integrator");]])
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
  set(says "${${kind}_says}")
  set(check "${${kind}_check}")
  set(template_test ${PROJECT_BINARY_DIR}/generated/framework/tools/program/test_template_${kind}.cpp)
  configure_file(${template_folder}/test_template.cpp.in ${template_test} @ONLY)
  foreach(template_file IN LISTS template_files template_test)
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
#include \"framework/tools/program/options.h\"

namespace lockstep {

std::string_view demo_scene() {
  return R\"lockstep(${demo_text})lockstep\";
}

}  // namespace lockstep
")
