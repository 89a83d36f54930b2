/* A client that sets the sensitivity of its argument, prints the properties of the device and of the driver as
 * Debian's libspnav returns them, and then its events, until the server disconnects or sends nothing for 60 s. */
#include <poll.h>
#include <spnav.h>
#include <stdio.h>
#include <stdlib.h>

/* libspnav 1.0 sends the lower half of a double instead of a float: here both have the same value. */
static double sensitivity(float value)
{
	union {
		double whole;
		float halves[2];
	} number = { value };

	number.halves[0] = value;
	return number.whole;
}

int main(int count, char **arguments)
{
	char name[64];
	unsigned int vendor, product;
	spnav_event event;

	if (count != 2 || spnav_open() == -1) {
		return 1;
	}
	spnav_client_name("a client with a name of more than twenty-four bytes");
	spnav_dev_name(name, sizeof name);
	printf("protocol %d, device %s, %d axes, %d buttons\n", spnav_protocol(), name, spnav_dev_axes(),
		spnav_dev_buttons());
	printf("sensitivity %d\n", spnav_sensitivity(sensitivity(atof(arguments[1]))));
	printf("ids %d, type %d, settings %g\n", spnav_dev_usbid(&vendor, &product), spnav_dev_type(),
		spnav_cfg_get_sens());
	fflush(stdout);
	for (;;) {
		struct pollfd file = { spnav_fd(), POLLIN, 0 };

		if (poll(&file, 1, 60000) != 1 || spnav_wait_event(&event) == 0) {
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
