#define SUPPLE_ISA avx2
#include "supple/fem/hex8_kernels_impl.h"

namespace supple::fem {
extern const Hex8Kernels hex8_kernels_avx2;
const Hex8Kernels hex8_kernels_avx2 = avx2::kHexKernels;
}  // namespace supple::fem
