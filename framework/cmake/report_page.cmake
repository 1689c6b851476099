# SPDX-License-Identifier: BSD-3-Clause
# The page of reports as text inside the library: framework/tools/report/web/dist/report.html, in pieces that every compiler
# takes as literals. `npm run build` in framework/tools/report/web makes that file; who changes no page needs no node.
set(report_page ${PROJECT_SOURCE_DIR}/framework/tools/report/web/dist/report.html)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${report_page})
set(report_page_source ${PROJECT_BINARY_DIR}/generated/framework/tools/report/page_pieces.cpp)
file(READ ${report_page} report_text)
string(LENGTH "${report_text}" report_length)
set(report_pieces "")
set(report_at 0)
while(report_at LESS report_length)
  string(SUBSTRING "${report_text}" ${report_at} 16000 report_piece)
  string(APPEND report_pieces "    R\"lockstep(${report_piece})lockstep\"sv,\n")
  math(EXPR report_at "${report_at} + 16000")
endwhile()
set(report_page_code "// Written by the configuration from framework/tools/report/web/dist/report.html.
#include \"framework/tools/report/page.h\"

namespace lockstep::report {

std::span<const std::string_view> page_pieces() {
  using namespace std::string_view_literals;
  static constexpr std::string_view pieces[] = {
${report_pieces}  };
  return pieces;
}

}  // namespace lockstep::report
")
set(report_page_before "")
if(EXISTS ${report_page_source})
  file(READ ${report_page_source} report_page_before)
endif()
if(NOT report_page_before STREQUAL report_page_code)
  file(WRITE ${report_page_source} "${report_page_code}")
endif()
