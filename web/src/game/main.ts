console.log("the game page comes here");
