#define SUPPLE_ISA avx2
#include "supple/solve/packed_kernels_impl.h"

namespace supple::solve {
extern const PackedKernels packed_kernels_avx2;
const PackedKernels packed_kernels_avx2 = avx2::kPackedKernels;
}  // namespace supple::solve
