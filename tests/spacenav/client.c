/* A 3D program: tells what Debian's libspnav makes of the device, then of its events, until nobody is
 * at the other end or nothing has come for ten seconds. */
#include <poll.h>
#include <spnav.h>
#include <stdio.h>

int main(void)
{
	char name[64];
	spnav_event event;

	if (spnav_open() == -1) {
		return 1;
	}
	spnav_client_name("a client with a name of more than twenty-four bytes");
	spnav_dev_name(name, sizeof name);
	printf("protocol %d, device %s, %d axes, %d buttons\n", spnav_protocol(), name, spnav_dev_axes(),
		spnav_dev_buttons());
	fflush(stdout);
	for (;;) {
		struct pollfd file = { spnav_fd(), POLLIN, 0 };

		if (poll(&file, 1, 10000) != 1 || spnav_wait_event(&event) == 0) {
			return 0;
		}
		if (event.type == SPNAV_EVENT_MOTION) {
			printf("motion %d %d %d %d %d %d\n", event.motion.x, event.motion.y, event.motion.z,
				event.motion.rx, event.motion.ry, event.motion.rz);
		} else if (event.type == SPNAV_EVENT_BUTTON) {
			printf("button %d %s\n", event.button.bnum, event.button.press ? "down" : "up");
		}
		fflush(stdout);
	}
}
