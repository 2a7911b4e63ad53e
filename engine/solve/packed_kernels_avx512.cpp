#define SUPPLE_ISA avx512
#include "supple/solve/packed_kernels_impl.h"

namespace supple::solve {
extern const PackedKernels packed_kernels_avx512;
const PackedKernels packed_kernels_avx512 = avx512::kPackedKernels;
}  // namespace supple::solve
