# impactrig_room(NAME SOURCES ... HEADERS ... [LINK ...] [LINK_PRIVATE ...] [PRECOMPILE ...])
#
# One static library per top-level folder, alias impactrig::NAME. Headers lie beside their sources and are
# included from the repository root, so the header set's base is the root, here and after installation.
# PRECOMPILE: headers of others, beyond the usual ones, that most of the sources take.
# Target all_verify_interface_header_sets compiles each header alone.
function(impactrig_room name)
  cmake_parse_arguments(room "" "" "SOURCES;HEADERS;LINK;LINK_PRIVATE;PRECOMPILE" ${ARGN})
  set(target impactrig_${name})
  add_library(${target} STATIC ${room_SOURCES})
  add_library(impactrig::${name} ALIAS ${target})
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES
    CXX_EXTENSIONS OFF
    EXPORT_NAME ${name}
    POSITION_INDEPENDENT_CODE ON
    VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(${target} PUBLIC
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${room_HEADERS})
  target_link_libraries(${target} PUBLIC ${room_LINK} PRIVATE ${room_LINK_PRIVATE})
  impactrig_precompile(${target} <fmt/format.h> ${room_PRECOMPILE})
  install(TARGETS ${target} EXPORT impactrig-targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/impactrig)
endfunction()
