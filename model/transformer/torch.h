// The part of LibTorch that the model needs; precompiled. `torch/torch.h` would add the data
// loaders, the ready-made layers and half a minute to every file.
#pragma once

#include <torch/autograd.h>
#include <torch/nn/module.h>
#include <torch/types.h>
#include <torch/version.h>

#define MOCAPLM_TORCH_AT_LEAST(major, minor) \
  (TORCH_VERSION_MAJOR > (major) ||          \
   (TORCH_VERSION_MAJOR == (major) && TORCH_VERSION_MINOR >= (minor)))
