// session [late]: a session of one thread with everything in it, always the same: prints what happened and the trajectory. The plain build
// and the one with slamgc print the same, to the last bit. late: nothing is freed, nor purged, before the end.
#include <cstdio>
#include <cstring>
#include <iostream>
#include <sstream>

#include "Session.h"

int main(int argc, char** argv) {
  using mini_orb::Session;
  Session session(60, false);
  session.collects = argc < 2 || std::strcmp(argv[1], "late") != 0;
  const auto tell = [&](const char* what) {
    const mini_orb::System::Summary now = session.system->GetSummary();
    std::printf(
        "%-18s state %d: %zu maps, %zu keyframes, %zu points; %zu frames, %d culled, %d loops, %d "
        "merges, %d global BAs\n",
        what, now.state, now.maps, now.keyframes, now.points, now.frames, now.culled, now.loops,
        now.merges, now.globalBAs);
    std::ostringstream trajectory;
    session.system->SaveTrajectory(trajectory);
    std::cout << trajectory.str();
    session.system->PrintMaps(std::cout);
    std::cout.flush();
  };
  session.Drive(4 * mini_orb::World::kLap);
  tell("four laps");
  session.Dark(30);
  session.Drive(2 * mini_orb::World::kLap);
  tell("lost, new map");
  session.system->ActivateLocalizationMode();
  session.Drive(mini_orb::World::kLap);
  tell("localisation");
  session.system->DeactivateLocalizationMode();
  session.Drive(mini_orb::World::kLap);
  std::stringstream file;
  session.system->SaveAtlas(file);
  session.system->ResetActiveMap();
  session.Drive(60);
  tell("active map reset");
  session.system->Reset();
  session.Drive(60);
  tell("reset");
  session.system->LoadAtlas(file);
  session.Drive(2 * mini_orb::World::kLap);
  tell("loaded");
  session.system->Shutdown();
  tell("shut down");
}
