#define SUPPLE_ISA baseline
#include "supple/fem/hex8_kernels_impl.h"

namespace supple::fem {
extern const Hex8Kernels hex8_kernels_baseline;
const Hex8Kernels hex8_kernels_baseline = baseline::kHexKernels;
}  // namespace supple::fem
