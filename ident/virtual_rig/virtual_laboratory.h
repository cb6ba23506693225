// The instruments of a virtual laboratory, as the paper's rig had them, with what they add to a
// signal.
//
// Ranges and noise are those of the classes of instruments named (data sheets round them so): an
// instrumented hammer of about 2 mV/N into a 24-bit converter of +-10 V, accelerometers of 100 mV/g
// with 1 % to 5 % transverse sensitivity, a 500 N tension cell and a 50 N load cell on 16-bit
// converters, an LVDT of +-25 mm.
#pragma once

#include "ident/virtual_rig/sensor_model.h"

namespace rigfit::ident {

struct VirtualInstruments {
  SensorModel hammer{.noise_std = 0.02, .offset_std = 0.05, .full_scale = 4400, .bits = 24};  ///< N
  SensorModel accelerometer{.noise_std = 3e-3,
                            .offset_std = 0.02,
                            .drift_per_s = 1e-3,
                            .random_walk_per_root_s = 1e-3,
                            .transverse_sensitivity = 0.03,
                            .full_scale = 690,
                            .bits = 24};  ///< m/s^2
  SensorModel tension_cell{.noise_std = 0.05,
                           .offset_std = 0.1,
                           .drift_per_s = 1e-4,
                           .random_walk_per_root_s = 1e-3,
                           .full_scale = 500,
                           .bits = 16};  ///< N
  SensorModel load_cell{.noise_std = 0.005,
                        .offset_std = 0.02,
                        .drift_per_s = 1e-4,
                        .random_walk_per_root_s = 5e-4,
                        .full_scale = 50,
                        .bits = 16};  ///< N
  SensorModel lvdt{.noise_std = 2e-6,
                   .offset_std = 5e-5,
                   .drift_per_s = 1e-8,
                   .random_walk_per_root_s = 1e-7,
                   .full_scale = 0.025,
                   .bits = 16};  ///< m
};

}  // namespace rigfit::ident
