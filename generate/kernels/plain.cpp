// The kernels for any processor.
#include "generate/kernels/bodies.h"

namespace mocaplm {

const Kernels kPlainKernels = {product_f32, prepare_bf16, product_bf16, prepare_int8, product_int8,
                               attend_f32,  attend_bf16,  nullptr,      nullptr,      layer_norm,
                               store,       store_gelu,   store_sum};

}  // namespace mocaplm
