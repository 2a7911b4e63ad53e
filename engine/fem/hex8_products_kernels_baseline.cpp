#define SUPPLE_ISA baseline
#include "supple/fem/hex8_products_kernels_impl.h"

namespace supple::fem {
extern const HexProductKernels hex_product_kernels_baseline;
const HexProductKernels hex_product_kernels_baseline = baseline::kHexProductKernels;
}  // namespace supple::fem
