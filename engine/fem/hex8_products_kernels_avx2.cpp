#define SUPPLE_ISA avx2
#include "supple/fem/hex8_products_kernels_impl.h"

namespace supple::fem {
extern const HexProductKernels hex_product_kernels_avx2;
const HexProductKernels hex_product_kernels_avx2 = avx2::kHexProductKernels;
}  // namespace supple::fem
