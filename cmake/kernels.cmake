# Kernel units: <room>/<name>_kernels_<isa>.cpp, each compiled with the flags of its instruction set and chosen at run time (math/isa.h).
# On other processors only `scalar` and `baseline` exist; baseline is then whatever the compiler's target has (NEON on ARM).
set(kernel_flags -O3 -ffp-contract=fast -fno-math-errno -fno-trapping-math)
set(kernel_isas scalar baseline)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  list(APPEND kernel_isas avx2 avx512)
  target_compile_definitions(supple_core PRIVATE SUPPLE_X86_KERNELS)
endif()
set(kernel_flags_scalar -ffp-contract=off)
set(kernel_flags_baseline "")
set(kernel_flags_avx2 -mavx2 -mfma)
set(kernel_flags_avx512 -mavx512f -mavx512dq -mavx512bw -mavx512cd -mavx512vl -mfma -mprefer-vector-width=512
    -Wno-uninitialized -Wno-maybe-uninitialized)  # false alarms in GCC 12's own intrinsic headers

# Under sanitizers the scalar units are instrumented in full; of the wide ones, the same source, only memory and threads: undefined-behaviour
# checks on every lane cost minutes of compilation and see nothing that the scalar units do not show.
if(SUPPLE_SANITIZE)
  list(APPEND kernel_flags -O1)  # the last one counts; at -O3 the checks take minutes to compile
  foreach(isa baseline avx2 avx512)
    list(APPEND kernel_flags_${isa} -fno-sanitize=undefined)
  endforeach()
endif()

foreach(isa scalar baseline avx2 avx512)
  file(GLOB units CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/engine/*/*_kernels_${isa}.cpp)
  if(isa IN_LIST kernel_isas)
    set_source_files_properties(${units} PROPERTIES COMPILE_OPTIONS "${kernel_flags};${kernel_flags_${isa}}")
  else()
    set_source_files_properties(${units} PROPERTIES HEADER_FILE_ONLY ON)
  endif()
endforeach()
