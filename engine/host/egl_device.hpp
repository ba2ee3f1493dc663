// Resolves a device name to an EGL device: LUCERNA_EGL_DEVICE, and schedulers' names for GPUs.
#pragma once

#include "host/host.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace lucerna {

/// Index into `devices` (eglDevices()). `name`:
///   N                  EGL's number
///   cuda:N, rocm:N     the Nth of NVIDIA's or AMD's devices in the order of their PCI slots, as Slurm counts them in
///                      CUDA_VISIBLE_DEVICES and ROCR_VISIBLE_DEVICES, and CUDA with CUDA_DEVICE_ORDER=PCI_BUS_ID
///   cuda:GPU-UUID      NVIDIA's by its UUID, or by a unique prefix of it
/// `sys` and `proc` are /sys and /proc except in tests. Throws Error(badInput) if there is no such device, or OpenGL
/// cannot draw with it (cuda:MIG-UUID: NVIDIA's graphics interfaces do not support GPU partitions).
std::size_t eglDeviceNamed(const std::string& name, const std::vector<EglDevice>& devices,
                           const std::filesystem::path& sys = "/sys", const std::filesystem::path& proc = "/proc");

}  // namespace lucerna
