#define SUPPLE_ISA avx512
#include "supple/fem/hex8_products_kernels_impl.h"

namespace supple::fem {
extern const HexProductKernels hex_product_kernels_avx512;
const HexProductKernels hex_product_kernels_avx512 = avx512::kHexProductKernels;
}  // namespace supple::fem
