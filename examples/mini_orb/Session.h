// Drives a system through the simulated world.
#pragma once

#include <memory>

#include "System.h"
#include "World.h"

namespace mini_orb {

struct Session {
  Session(int features, bool threads)
      : world(7, features), system(std::make_unique<System>(threads)) {}

  // So many frames on along the track.
  void Drive(int frames) {
    for (; frames != 0; --frames, ++place)
      system->TrackRGBD(world.Look(World::kStep * static_cast<double>(place), number++));
  }
  // The camera is covered while it goes on.
  void Dark(int frames) {
    for (; frames != 0; --frames, ++place) system->TrackRGBD(World::Dark(number++));
  }

  World world;
  std::unique_ptr<System> system;
  unsigned long place = 0, number = 0;
};

}  // namespace mini_orb
