// Drives a system through the simulated world.
#pragma once

#include <memory>

#include "System.h"
#include "World.h"

namespace mini_orb {

// Whether what is culled is freed: the tests ask.
inline constexpr bool kReclaims = false;

struct Session {
  Session(int features, bool threads)
      : world(7, features), system(std::make_unique<System>(threads)), collects(!threads) {}

  // So many frames on along the track.
  void Drive(int frames) {
    for (; frames != 0; --frames, ++place)
      Track(world.Look(World::kStep * static_cast<double>(place), number++));
  }
  // The camera is covered while it goes on.
  void Dark(int frames) {
    for (; frames != 0; --frames, ++place) Track(World::Dark(number++));
  }
  void Track(const Image& image) {
    if (collects) system->Collect();
    system->TrackRGBD(image);
  }

  World world;
  std::unique_ptr<System> system;
  bool collects;  // before each frame, since there is no thread that does it
  unsigned long place = 0, number = 0;
};

}  // namespace mini_orb
