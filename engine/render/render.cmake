# supple::render: OpenGL through libepoxy, EGL without a display. Shaders and the font are embedded at build time, so the
# library needs no file of its own at run time.
find_package(PkgConfig REQUIRED)
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
find_path(SUPPLE_STB_INCLUDE stb/stb_truetype.h)
if(NOT SUPPLE_STB_INCLUDE)
  message(FATAL_ERROR "stb/stb_truetype.h is missing: apt-get install libstb-dev, or configure with -DSUPPLE_RENDER=OFF")
endif()
find_file(SUPPLE_FONT DejaVuSans.ttf PATHS
  /usr/share/fonts/truetype/dejavu /usr/share/fonts/dejavu /usr/share/fonts/dejavu-sans-fonts /usr/share/fonts/TTF NO_DEFAULT_PATH)
if(NOT SUPPLE_FONT)
  message(FATAL_ERROR "DejaVuSans.ttf is missing: apt-get install fonts-dejavu-core, or name the file with -DSUPPLE_FONT=..., "
                      "or configure with -DSUPPLE_RENDER=OFF")
endif()

file(GLOB supple_shaders CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/shaders/*.vert ${PROJECT_SOURCE_DIR}/shaders/*.frag ${PROJECT_SOURCE_DIR}/shaders/*.glsl)
set(supple_embedded ${PROJECT_BINARY_DIR}/generated/render)

# The font changes never, the shaders often: two files, so that an edited shader recompiles in a second.
function(supple_embed output function)
  string(REPLACE ";" "|" inputs "${ARGN}")
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DFUNCTION=${function} "-DINPUTS=${inputs}" -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    COMMENT "Embedding ${function}" VERBATIM)
endfunction()
supple_embed(${supple_embedded}/shaders.cpp supple::render::embedded_shader ${supple_shaders})
supple_embed(${supple_embedded}/font.cpp supple::render::embedded_font ${SUPPLE_FONT})

supple_library(render render)
target_sources(supple_render PRIVATE ${supple_embedded}/shaders.cpp ${supple_embedded}/font.cpp)
target_include_directories(supple_render SYSTEM PRIVATE ${SUPPLE_STB_INCLUDE})
target_link_libraries(supple_render PUBLIC supple_core PRIVATE $<BUILD_INTERFACE:PkgConfig::EPOXY> ${CMAKE_DL_LIBS})
