# SPDX-License-Identifier: BSD-3-Clause
# Target doc, if Doxygen is found: writes HTML of the C API and the VTK classes to doc/. Any warning of Doxygen is an error.
find_program(DOXYGEN doxygen)
mark_as_advanced(DOXYGEN)
if (NOT DOXYGEN)
  return ()
endif ()
file(GLOB stratus_doc_headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/Filters/*/vtkStratus*.h" "${PROJECT_SOURCE_DIR}/Rendering/*/vtkStratus*.h"
  "${PROJECT_SOURCE_DIR}/ParaView/*/vtkStratus*.h")
# Comments of public headers begin with the class's name; headers that are private to a module have no such comment.
set(stratus_doc_input "\"${PROJECT_SOURCE_DIR}/Core/stratus.h\" \"${PROJECT_SOURCE_DIR}/Core/stratus\"")
foreach (header IN LISTS stratus_doc_headers)
  file(STRINGS "${header}" class REGEX "@class")
  if (class)
    string(APPEND stratus_doc_input " \\\n                         \"${header}\"")
  endif ()
endforeach ()
set(stratus_doc_filter "${PROJECT_SOURCE_DIR}/cmake/comments-for-doxygen")
set(stratus_doc_predefined "")
foreach (macro IN ITEMS
    "vtkTypeMacro(a, b)=" "STRATUS_API=" "STRATUS_EXPERIMENTAL=" "vtkBooleanMacro(name, type)=virtual void name##On()\; virtual void name##Off()\;"
    "vtkGetMacro(name, type)=virtual type Get##name()\;" "vtkSetMacro(name, type)=virtual void Set##name(type value)\;"
    "vtkSetClampMacro(name, type, low, high)=virtual void Set##name(type value)\;"
    "vtkSetFilePathMacro(name)=virtual void Set##name(const char* path)\;" "vtkGetFilePathMacro(name)=virtual const char* Get##name()\;"
    "vtkSetStringMacro(name)=virtual void Set##name(const char* text)\;" "vtkGetStringMacro(name)=virtual const char* Get##name()\;"
    "vtkSetVector2Macro(name, type)=virtual void Set##name(type a, type b)\;" "vtkGetVector2Macro(name, type)=virtual type* Get##name()\;"
    "vtkSetVector3Macro(name, type)=virtual void Set##name(type a, type b, type c)\;" "vtkGetVector3Macro(name, type)=virtual type* Get##name()\;"
    "vtkGetObjectMacro(name, type)=virtual type* Get##name()\;" "vtkSetObjectMacro(name, type)=virtual void Set##name(type* value)\;"
    "VTK_SIZEHINT(n)=" "VTK_NEWINSTANCE=" "VTK_STRATUS_PRIVATE=")
  string(APPEND stratus_doc_predefined " \\\n                         \"${macro}\"")
endforeach ()
foreach (module IN LISTS stratus_doc_headers)
  file(STRINGS "${module}" export REGEX "^class [A-Z]+_EXPORT")
  if (export MATCHES "class ([A-Z]+_EXPORT)")
    string(APPEND stratus_doc_predefined " \\\n                         \"${CMAKE_MATCH_1}=\"")
  endif ()
endforeach ()
configure_file("${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in" "${CMAKE_BINARY_DIR}/Doxyfile" @ONLY)
add_custom_target(doc COMMAND "${DOXYGEN}" "${CMAKE_BINARY_DIR}/Doxyfile" WORKING_DIRECTORY "${CMAKE_BINARY_DIR}" VERBATIM
  COMMENT "Documentation into ${CMAKE_BINARY_DIR}/doc/html")
