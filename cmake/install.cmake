# Installs the libraries, the headers that a client can reach, the CMake package `supple`, a pkg-config file and the program.
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/supple)

# One export set per library: a client that has no epoxy can still use supple::core.
set(SUPPLE_INSTALLED core c)
if(SUPPLE_IO)
  list(APPEND SUPPLE_INSTALLED io)
endif()
if(SUPPLE_RENDER)
  list(APPEND SUPPLE_INSTALLED render)
  set(SUPPLE_RENDER_MODULES epoxy)  # pkg-config modules that its clients link
endif()
foreach(name IN LISTS SUPPLE_INSTALLED)
  install(TARGETS supple_${name} EXPORT supple_${name}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT supple_${name} NAMESPACE supple:: FILE supple_${name}.cmake DESTINATION ${package_dir})
endforeach()

# The public headers are those that these reach; everything else in engine/ stays at home.
set(queue supple.h bindings/c/supple.h)
if(SUPPLE_IO)
  list(APPEND queue io/mesh_file.h io/scene.h io/text_files.h io/report.h)
endif()
if(SUPPLE_RENDER)
  list(APPEND queue render/renderer.h render/context.h render/camera.h render/color_map.h render/image.h render/video.h)
endif()
set(public_headers)
while(queue)
  list(POP_FRONT queue header)
  if(header IN_LIST public_headers)
    continue()
  endif()
  set(file ${PROJECT_SOURCE_DIR}/engine/${header})
  if(NOT EXISTS ${file})
    message(FATAL_ERROR "public header ${header} does not exist")
  endif()
  list(APPEND public_headers ${header})
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(STRINGS ${file} includes REGEX "^#[ \t]*include[ \t]+[<\"]supple/")
  foreach(line IN LISTS includes)
    string(REGEX REPLACE ".*[<\"]supple/([^>\"]+)[>\"].*" "\\1" included "${line}")
    list(APPEND queue ${included})
  endforeach()
endwhile()
foreach(header IN LISTS public_headers)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/engine/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/supple/${folder})
endforeach()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/suppleConfig.cmake.in ${PROJECT_BINARY_DIR}/suppleConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/suppleConfig.cmake ${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake DESTINATION ${package_dir})

# pkg-config: supple::core, with the io library where it was built.
file(RELATIVE_PATH SUPPLE_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" SUPPLE_PC_PREFIX "${SUPPLE_PC_PREFIX}")
set(SUPPLE_PC_LIBS "-lsupple_core")
if(SUPPLE_IO)
  string(PREPEND SUPPLE_PC_LIBS "-lsupple_io ")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/supple.pc.in ${PROJECT_BINARY_DIR}/supple.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/supple.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

if(SUPPLE_PROGRAM)
  install(TARGETS supple RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/supple/assets
    FILES_MATCHING PATTERN "*.msh" PATTERN "*.json")
endif()
