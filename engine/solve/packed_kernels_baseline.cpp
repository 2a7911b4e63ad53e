#define SUPPLE_ISA baseline
#include "supple/solve/packed_kernels_impl.h"

namespace supple::solve {
extern const PackedKernels packed_kernels_baseline;
const PackedKernels packed_kernels_baseline = baseline::kPackedKernels;
}  // namespace supple::solve
