#define SUPPLE_SCALAR_LANES
#define SUPPLE_ISA scalar
#include "supple/fem/hex8_products_kernels_impl.h"

namespace supple::fem {
extern const HexProductKernels hex_product_kernels_scalar;
const HexProductKernels hex_product_kernels_scalar = scalar::kHexProductKernels;
}  // namespace supple::fem
