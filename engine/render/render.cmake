# supple::render: OpenGL through libepoxy, EGL without a display; shaders/*.{vert,frag,glsl} are embedded at build time.
find_package(PkgConfig REQUIRED)
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
supple_library(render render)
target_link_libraries(supple_render PUBLIC supple_core PRIVATE $<BUILD_INTERFACE:PkgConfig::EPOXY>)
