# What a report page carries along: its style and script, three.js with the examples that the views use (Debian:
# libjs-three). Sets `report_assets_source`, a source whose object holds the files' bytes.
find_file(RICCI_THREE_JS three.min.js PATHS /usr/share/javascript/three /usr/share/javascript/three/build NO_DEFAULT_PATH)
if(NOT RICCI_THREE_JS)
    message(FATAL_ERROR "three.js not found (Debian: libjs-three); -DRICCI_THREE_JS=FILE names it elsewhere, "
        "release 111 with its folder examples/js beside it")
endif()
get_filename_component(three_folder "${RICCI_THREE_JS}" REALPATH)
get_filename_component(three_folder "${three_folder}" DIRECTORY)
set(three_extras "")
foreach(script controls/OrbitControls lines/LineSegmentsGeometry lines/LineGeometry lines/LineMaterial lines/LineSegments2 lines/Line2)
    set(three_file "${three_folder}/examples/js/${script}.js")
    if(NOT EXISTS "${three_file}")
        message(FATAL_ERROR "${three_file} is missing: the report needs release 111 of three.js with its examples")
    endif()
    file(READ "${three_file}" three_text)
    string(APPEND three_extras "${three_text}\n")
endforeach()
file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/generated/three_extras.js" CONTENT "${three_extras}" @ONLY)
set(report_assets_source "${PROJECT_BINARY_DIR}/generated/report_assets.cpp")
configure_file(engine/app/report/assets.cpp.in "${report_assets_source}" @ONLY)
set_source_files_properties("${report_assets_source}" PROPERTIES OBJECT_DEPENDS
    "${PROJECT_SOURCE_DIR}/engine/app/report/assets/report.css;${PROJECT_SOURCE_DIR}/engine/app/report/assets/report.js;${RICCI_THREE_JS};${PROJECT_BINARY_DIR}/generated/three_extras.js")
