# SPDX-License-Identifier: BSD-3-Clause
# What a Debian package must hold beside our files: its copyright, its changelog, compressed manual pages. CPack runs this
# when the files of each component are in place, before it packs them.
set(root "${CPACK_TEMPORARY_DIRECTORY}")
set(day ${CPACK_LOCKSTEP_DAY})
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  if(NOT IS_DIRECTORY "${root}/${component}/usr")
    continue()
  endif()
  string(TOUPPER ${component} COMPONENT)
  set(package ${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME})
  set(doc "${root}/${component}/usr/share/doc/${package}")
  file(MAKE_DIRECTORY "${doc}")
  configure_file("${CPACK_LOCKSTEP_LICENSE}" "${doc}/copyright" COPYONLY)
  file(WRITE "${doc}/changelog"
"lockstep (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * See framework/CHANGELOG.md in package lockstep-doc.

 -- ${CPACK_PACKAGE_CONTACT}  ${day}
")
  file(GLOB_RECURSE pages "${root}/${component}/usr/share/man/*.1")
  foreach(file IN LISTS pages ITEMS "${doc}/changelog")
    execute_process(COMMAND gzip -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  file(GLOB_RECURSE files "${doc}/*")
  file(CHMOD ${files} FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endforeach()
